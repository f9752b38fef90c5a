"""Pictures: in and out, how far apart, how wrong."""
