"""OpenCL: devices, implementations, programs, number types."""
