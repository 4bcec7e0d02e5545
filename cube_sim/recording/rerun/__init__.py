"""The view: Rerun columns, scene, plots and their layout."""
