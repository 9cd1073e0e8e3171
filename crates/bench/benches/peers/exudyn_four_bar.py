"""Four-bar with two clearance joints (examples/four-bar.toml) in EXUDYN 1.13.6.

pip install exudyn==1.13.6; python exudyn_four_bar.py FILE.csv [STEP_S] [log=SEED] [NAME=VALUE...]

With `log` it writes the channels of examples/four-bar-log.toml with noise. Each further NAME is a
constant of CHANGES, which makes the bench another than the described one.

Rigid bodies, ideal joints and drive are EXUDYN's own; the contact force is a user function, because
EXUDYN has no law with a latched approach speed. Trapezoidal rule, index 2, constant step.
"""
import sys
from math import sqrt, tanh, hypot
import exudyn as exu
from exudyn.itemInterface import (MarkerBodyPosition, MarkerBodyRigid, MarkerNodeCoordinate,
                                  NodePointGround, NodeRigidBody2D, ObjectConnectorCartesianSpringDamper,
                                  ObjectConnectorCoordinate, ObjectGround, ObjectJointRevolute2D,
                                  ObjectRigidBody2D, LoadForceVector, LoadTorqueVector)
import numpy as np

# Clearance, friction coefficient and restitution of the joint of rocker and coupler, mass of the
# rocker over its described one, viscous torque at the rocker's pin in N m s/rad.
CHANGES = {"clearance_m": 0.25e-3, "mu": 0.1, "restitution": 0.5, "rocker_mass": 1.0, "viscous": 0.0}
# Noise of the log's channels.
ANGLE_NOISE_RAD, TORQUE_NOISE_NM, JOURNAL_NOISE_M = 5e-5, 1.0, 2e-6

given = dict(argument.split("=") for argument in sys.argv[2:] if "=" in argument)
SEED = given.pop("log", None)
unknown = sorted(set(given) - set(CHANGES))
if unknown:
    sys.exit(f"{', '.join(unknown)}: expected {', '.join(CHANGES)} or log")
CHANGED = CHANGES | {name: float(value) for name, value in given.items()}
steps = [argument for argument in sys.argv[2:] if "=" not in argument]
STEP_S = float(steps[0]) if steps else 1e-6
END_S = 0.12566370614359174
SPEED = 50.0
GRAVITY = 9.81
O, A, B, D = (0.0, 0.0), (0.0, 0.1), (0.24, 0.2), (0.25, 0.0)
# The two joints: as described, and changed.
R_B, CLEARANCE = 0.01, (CHANGES["clearance_m"], CHANGED["clearance_m"])
R_J = [R_B - clearance for clearance in CLEARANCE]
E_PA, NU, FLOOR = 207e9, 0.3, 0.01
RESTITUTION = (CHANGES["restitution"], CHANGED["restitution"])
MU, V_R = (CHANGES["mu"], CHANGED["mu"]), 0.01
H = (1 - NU**2) / E_PA
K = [4 / (3 * 2 * H) * sqrt(R_B * journal / clearance) for journal, clearance in zip(R_J, CLEARANCE)]
CHI = [8 * (1 - e) / (5 * e) for e in RESTITUTION]

SC = exu.SystemContainer()
mbs = SC.AddSystem()


def bar(mass, p, q, rate):
    length = hypot(q[0] - p[0], q[1] - p[1])
    angle = np.arctan2(q[1] - p[1], q[0] - p[0])
    reference = [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, angle]
    node = mbs.AddNode(NodeRigidBody2D(referenceCoordinates=reference, initialVelocities=list(rate)))
    body = mbs.AddObject(ObjectRigidBody2D(mass=mass, inertia=mass * length**2 / 12, nodeNumber=node))
    marker = mbs.AddMarker(MarkerBodyPosition(bodyNumber=body))
    mbs.AddLoad(LoadForceVector(markerNumber=marker, loadVector=[0, -mass * GRAVITY, 0]))
    return dict(node=node, body=body, reference=np.array(reference), half=length / 2)


# Speeds of the ideal four-bar: v_B from the crank's pin and from the rocker agree.
w1 = SPEED
va = np.array([-w1 * A[1], w1 * A[0]])
ab, db = np.subtract(B, A), np.subtract(B, D)
w2, w3 = np.linalg.solve(np.array([[-ab[1], db[1]], [ab[0], -db[0]]]), -va)
vb = np.array([-w3 * db[1], w3 * db[0]])
crank = bar(0.5, O, A, [va[0] / 2, va[1] / 2, w1])
coupler = bar(1.0, A, B, [(va[0] + vb[0]) / 2, (va[1] + vb[1]) / 2, w2])
rocker = bar(0.8 * CHANGED["rocker_mass"], D, B, [vb[0] / 2, vb[1] / 2, w3])

ground = mbs.AddObject(ObjectGround())
ground_node = mbs.AddNode(NodePointGround())
for body, point in ((crank, O), (rocker, D)):
    on_ground = mbs.AddMarker(MarkerBodyPosition(bodyNumber=ground, localPosition=[*point, 0]))
    on_body = mbs.AddMarker(MarkerBodyPosition(bodyNumber=body["body"], localPosition=[-body["half"], 0, 0]))
    mbs.AddObject(ObjectJointRevolute2D(markerNumbers=[on_ground, on_body]))
fixed = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=ground_node, coordinate=0))
angle = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=crank["node"], coordinate=2))
drive = mbs.AddObject(ObjectConnectorCoordinate(
    markerNumbers=[fixed, angle],
    offsetUserFunction=lambda mbs, t, item, offset: SPEED * t,
    offsetUserFunction_t=lambda mbs, t, item, offset: SPEED))

# Joints: bearing's body and end, journal's body and end.
JOINTS = [(crank, 1, coupler, -1), (rocker, 1, coupler, 1)]
latched = [None, None]


def end(body, side):
    """Position and velocity of an end, and the body's speed."""
    q = body["reference"] + mbs.GetNodeOutput(body["node"], exu.OutputVariableType.Coordinates)
    v = mbs.GetNodeOutput(body["node"], exu.OutputVariableType.Coordinates_t)
    arm = side * body["half"] * np.array([np.cos(q[2]), np.sin(q[2])])
    return q[:2] + arm, v[:2] + v[2] * np.array([-arm[1], arm[0]]), v[2]


def contact(k):
    """Depth, rate, normal force, friction force, normal and tangent of a joint."""
    bearing, side_b, journal, side_j = JOINTS[k]
    p, vp, wb = end(bearing, side_b)
    q, vq, wj = end(journal, side_j)
    r = q - p
    distance = sqrt(r[0]**2 + r[1]**2)
    n = r / distance if distance > 0 else np.zeros(2)
    t = np.array([-n[1], n[0]])
    depth, rate = distance - CLEARANCE[k], float(n @ (vq - vp))
    if depth <= 0:
        return depth, rate, 0.0, 0.0, n, t
    v0 = max(latched[k] if latched[k] is not None else max(rate, 0.0), FLOOR)
    normal = max(K[k] * depth**1.5 * (1 + CHI[k] * rate / v0), 0.0)
    sliding = float(t @ (vq - vp)) + wj * R_J[k] - wb * R_B
    return depth, rate, normal, -MU[k] * normal * tanh(sliding / V_R), n, t


def force(k):
    def user(mbs, t, item, displacement, velocity, stiffness, damping, offset):
        _, _, normal, friction, n, tangent = contact(k)
        f = normal * n - friction * tangent
        return [float(f[0]), float(f[1]), 0.0]
    return user


def torque(k, radius, sign):
    def user(mbs, t, load):
        return [0.0, 0.0, sign * radius * contact(k)[3]]
    return user


for k, (bearing, side_b, journal, side_j) in enumerate(JOINTS):
    markers = [mbs.AddMarker(MarkerBodyPosition(bodyNumber=b["body"], localPosition=[s * b["half"], 0, 0]))
               for b, s in ((bearing, side_b), (journal, side_j))]
    mbs.AddObject(ObjectConnectorCartesianSpringDamper(markerNumbers=markers, springForceUserFunction=force(k)))
    for body, radius, sign in ((bearing, R_B, -1.0), (journal, R_J[k], 1.0)):
        marker = mbs.AddMarker(MarkerBodyRigid(bodyNumber=body["body"]))
        mbs.AddLoad(LoadTorqueVector(markerNumber=marker, loadVectorUserFunction=torque(k, radius, sign)))

def rub(mbs, t, load):
    speed = mbs.GetNodeOutput(rocker["node"], exu.OutputVariableType.Coordinates_t)[2]
    return [0.0, 0.0, -CHANGED["viscous"] * speed]


if CHANGED["viscous"] != 0.0:
    on_rocker = mbs.AddMarker(MarkerBodyRigid(bodyNumber=rocker["body"]))
    mbs.AddLoad(LoadTorqueVector(markerNumber=on_rocker, loadVectorUserFunction=rub))

rows = []
log = []
impacts = []  # joint, onset s, approach speed m/s, largest force N, separation s
EVERY = round(2e-4 / STEP_S)
count = 0


def before_step(mbs, t):
    global count
    t = count * STEP_S
    for k in range(2):
        depth, rate, normal = contact(k)[:3]
        if depth <= 0 and latched[k] is not None:
            latched[k] = None
            next(i for i in reversed(impacts) if i[0] == k)[4] = t
        elif depth > 0 and latched[k] is None:
            latched[k] = max(rate, 0.0)
            impacts.append([k, t, latched[k], 0.0, float("nan")])
        if depth > 0:
            impact = next(i for i in reversed(impacts) if i[0] == k)
            impact[3] = max(impact[3], normal)
    if count % EVERY == 0:
        a, b = contact(0), contact(1)
        state = [b["reference"] + mbs.GetNodeOutput(b["node"], exu.OutputVariableType.Coordinates)
                 for b in (crank, coupler, rocker)]
        offset = end(coupler, 1)[0] - end(rocker, 1)[0]
        # The force of the constraint acts against the drive.
        torque_nm = -np.ravel(mbs.GetObjectOutput(drive, exu.OutputVariableType.Force))[0]
        log.append([t, state[2][2], torque_nm, *offset])
        rows.append([t, a[2], b[2], state[1][0], state[1][1], state[1][2], state[2][2]])
    count += 1
    return True


mbs.SetPreStepUserFunction(before_step)
mbs.Assemble()
settings = exu.SimulationSettings()
settings.timeIntegration.numberOfSteps = round(END_S / STEP_S)
settings.timeIntegration.endTime = END_S
settings.timeIntegration.verboseMode = 0
settings.timeIntegration.newton.useModifiedNewton = True
settings.timeIntegration.newton.relativeTolerance = 1e-9
settings.timeIntegration.newton.absoluteTolerance = 1e-9
settings.timeIntegration.newton.numericalDifferentiation.forODE2 = False
settings.solution.file.write = False
mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2)
if SEED is not None:
    noise = np.random.default_rng(int(SEED)).normal(size=(len(log), 4))
    noise *= [ANGLE_NOISE_RAD, TORQUE_NOISE_NM, JOURNAL_NOISE_M, JOURNAL_NOISE_M]
    with open(sys.argv[1], "w") as file:
        file.write("t_s,shaft_angle_rad,drive_torque_nm,journal_y_m,journal_z_m\n")
        for row, random in zip(log, noise):
            file.write(f"{row[0]:.6g}," + ",".join(f"{v + n:.8g}" for v, n in zip(row[1:], random)) + "\n")
    sys.exit()
with open(sys.argv[1], "w") as file:
    file.write("contact,onset_s,approach_speed_m_s,peak_force_n,separation_s\n")
    for impact in impacts:
        file.write(",".join(f"{value:.8g}" for value in impact) + "\n")
    file.write("t_s,force_a_n,force_b_n,coupler_x_m,coupler_y_m,coupler_angle_rad,rocker_angle_rad\n")
    for row in rows:
        file.write(",".join(f"{value:.9g}" for value in row) + "\n")
