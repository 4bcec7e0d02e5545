"""What several tests share: vehicles, references, flights."""
