"""Missions drawn, forecast, flown, judged and shown: the parts of `benchmarks/missions.py`."""
