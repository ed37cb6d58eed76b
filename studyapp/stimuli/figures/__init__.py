"""Pictures for researchers and papers: contact sheets, figures, previews of motion."""
