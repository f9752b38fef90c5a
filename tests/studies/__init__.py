"""What tests and benches both run."""
