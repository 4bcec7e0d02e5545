"""What a run leaves behind: a table of channels, the MCAP record, and its Rerun view.

The MCAP is the record. ``run.rrd`` is a function of it and of the model, so it can always be made again.
Nothing is imported here: reading a recording must not cost a viewer's import, nor the other way round.
"""
