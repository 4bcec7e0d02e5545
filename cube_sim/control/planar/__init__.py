"""Path following in the plane for a vehicle with a force ahead and a torque (Lapierre and Soetanto 2007)."""
