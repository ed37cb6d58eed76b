"""Speed and accuracy of the statistics compared with other implementations."""
