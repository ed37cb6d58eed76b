"""How well learned generators move to speech whose motion is known: the corpus' own."""
