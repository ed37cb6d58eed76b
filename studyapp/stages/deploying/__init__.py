"""Every file that a server needs to serve a study to the world."""
