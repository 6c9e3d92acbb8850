"""Running stages over the models of a corpus."""
