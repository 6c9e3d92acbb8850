"""Pictures of models and charts over a corpus."""
