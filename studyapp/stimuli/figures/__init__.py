"""What researchers look at and papers show: contact sheets, figures, previews of motion."""
