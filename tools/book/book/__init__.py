"""The parts of the generator of the book."""
