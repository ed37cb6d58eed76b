"""Pictures and sound into files, and files copied and dubbed."""
