"""The exact search: the forces of least cost that make a wrench, over the union of all dead-zone subsets."""
