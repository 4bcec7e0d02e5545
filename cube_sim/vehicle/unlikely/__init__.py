"""Numbers of a model that are possible, and most likely not meant: another unit, or a site that is turned round."""
