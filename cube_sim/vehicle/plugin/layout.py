"""Where the water's parameters lie inside a compiled model: the one array that the compiled callbacks read.

The array is the model's last custom numeric, `PACKED`. Its header says where the records start, each index counting
doubles from the array's beginning:

    header          MAGIC, number of hulls, start of the hull records, start of the thruster table,
                    start of the current's table or -1, number of the process whose user forces it names,
                    start of the table of pushes or -1, start of the tables of lift or -1, height of the water's surface
                    [m] or inf where there is none, start of the propellers or -1, number of links, start of theirs,
                    start of the ballast or -1, start of the servos of fins or -1
    hull records    HULL_SIZE values each; matrices lie there column by column, and the added mass is symmetric;
                    REACH [m] is the height above its origin that no part of it is beyond in any attitude, -inf for a
                    hull without extent; SEES is 1 where its own force sees commands and activations, STATES how many
                    numbers that force keeps, STATE where they lie among the activations, RATES where `passive` leaves
                    their rates among the user data, since MuJoCo clears their place until the actuators' turn; ARM is
                    how many degrees of freedom its tree has behind its own six, 0 where no link of it has water;
                    COMMAND and COMMANDS are the first of the actuators that its own force sees and how many it sees,
                    ACTIVATION and ACTIVATIONS the same of their activations
    link records    the same values of each link: DOF is the last of the degrees of freedom that move it, and a link has
                    no force of its own
    thruster table  one value per actuator of the model: the start of its curve record, -1 for no thruster, -2 for the
                    servo of a fin, -3 for what keeps the state of an own force, -4 for a pump of ballast
    curve records   c_DZ-, c_DZ+, F_DZ-, F_DZ+ [N], n, efficiency, supply, stuck [N], k_P-, k_P+ [W/N^1.5],
                    voltage [V], pulse widths of the commands -1, 0 and 1 [us], number of its propeller or -1,
                    start of its record of voltages or -1, c_1..c_n, F_1..F_n [N]; stuck is NaN for a thruster that is
                    free; voltage and pulses are NaN where not known; of a propeller the curve is that of water that
                    does not flow
    pushes          n, and n rows as `cube_sim.vehicle.laws.push` has them
    lift            numbers of velocity products, strips, fins, products with a fin's deflection and with its square,
                    and a row for each as the laws `body_lift` and `fin` of `cube_sim.vehicle.laws` have them; where a
                    deflection is in it, the fin's number stands for the hull's
    propellers      n, number of values in open-water points, n rows as `cube_sim.vehicle.laws.propeller` has them, and
                    these points
    ballast         n, and n rows as `cube_sim.vehicle.laws.ballast` has them
    servos          n, and n rows as `cube_sim.vehicle.laws.servo_fault` has them, one for each fin that a servo turns
    voltages        of each table of curves at several voltages, as `cube_sim.vehicle.laws.voltage_law` has it
    current         n_t, n_z, t_1.. [s], z_1.. [m], (v_x, v_y, v_z) [m/s] time by time

`cube_sim.vehicle.plugin.packing` writes it. Efficiency, supply, stuck, a curve that has a record of voltages, the
servos' faults, the velocities of the current and the pushes are meant to change while a model is in use
(`cube_sim.vehicle.faults`, `cube_sim.vehicle.fin_faults`, `cube_sim.vehicle.current`, `cube_sim.vehicle.pushes`).
"""

from __future__ import annotations

import struct

PACKED = "cube_sim:packed"
MAGIC = -7.390851332151607e-137  # nobody's physical value; the callbacks' test for "one of ours"
MAGIC_BITS = struct.unpack("=q", struct.pack("=d", MAGIC))[0]  # the same as the integer that its bytes are

FORCE_TABLE = "cube_sim_force_table"  # the linker's name of this process's table of user forces

# the header
COUNT, HULLS, THRUSTERS, CURRENT, PROCESS, PUSHES, LIFT, SURFACE, PROPELLERS = 1, 2, 3, 4, 5, 6, 7, 8, 9
LINK_COUNT, LINKS, BALLAST, SERVOS = 10, 11, 12, 13
HEADER_SIZE = 14
# in the thruster table
NO_THRUSTER, FIN_SERVO, FORCE_STATE, BALLAST_STATE = -1, -2, -3, -4
# one hull record, or link record
BODY, DOF, DISPLACED_MASS, CENTRE, ADDED_MASS, LINEAR, QUADRATIC, FORCE = 0, 1, 2, 3, 6, 42, 78, 114
REACH, HALF_AXES = 115, 116
SEES, STATES, STATE, RATES = 119, 120, 121, 122
ARM = 123
COMMAND, COMMANDS, ACTIVATION, ACTIVATIONS = 124, 125, 126, 127
HULL_SIZE = 128
# one curve record
DEAD_LOW, DEAD_HIGH, ZONE_LOW, ZONE_HIGH, POINTS = 0, 1, 2, 3, 4
EFFICIENCY, SUPPLY, STUCK, POWER, VOLTAGE, PULSE, PROPELLER, TABLES, CURVE = 5, 6, 7, 8, 10, 11, 14, 15, 16
