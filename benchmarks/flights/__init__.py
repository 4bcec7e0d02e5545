"""Missions drawn, forecast and asked, and flights beside foils: the parts of `draw_mission.py` and `stuck.py`."""
