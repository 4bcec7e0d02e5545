"""What a vehicle knows of its own motion: sensors with errors, and the filter that makes one estimate of them."""
