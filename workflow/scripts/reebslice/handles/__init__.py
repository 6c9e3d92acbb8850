"""Morse events and their handle operations."""
