"""Checks exported units with two co-simulation programs that the project did not write.

    python check.py FILE.fmu...

FMPy validates each unit, takes steps, and saves, serialises and restores its state. libcosimpy (FMI
2.0 only) takes the same steps. Every difference is an error.
"""

import sys
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

STEP_S = 1e-3
STEPS = 100
# The programs add up their steps in another order, and the integrator's steps follow the times.
MAX_DIFFERENCE = 1e-7


class Unit:
    """A unit in FMPy, of either version."""

    def __init__(self, file):
        self.description = fmpy.read_model_description(str(file))
        self.folder = fmpy.extract(str(file))
        self.is_3 = self.description.fmiVersion.startswith("3")
        kind = FMU3Slave if self.is_3 else FMU2Slave
        self.slave = kind(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="unit",
        )
        self.slave.instantiate()
        if self.is_3:
            self.slave.enterInitializationMode(startTime=0.0)
        else:
            self.slave.setupExperiment(startTime=0.0)
            self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        real = [v for v in self.description.modelVariables if v.type in ("Real", "Float64")]
        self.outputs = [v for v in real if v.causality == "output"]
        self.inputs = {v.name: v for v in real if v.causality == "input"}

    def set(self, name, value):
        write = self.slave.setFloat64 if self.is_3 else self.slave.setReal
        write([self.inputs[name].valueReference], [value])

    def values(self):
        read = self.slave.getFloat64 if self.is_3 else self.slave.getReal
        return list(read([v.valueReference for v in self.outputs]))

    def step(self, number):
        self.slave.doStep(currentCommunicationPoint=number * STEP_S, communicationStepSize=STEP_S)
        return self.values()

    def state(self):
        """Bytes of the state: saved, serialised, freed."""
        get = self.slave.getFMUState if self.is_3 else self.slave.getFMUstate
        free = self.slave.freeFMUState if self.is_3 else self.slave.freeFMUstate
        serialise = self.slave.serializeFMUState if self.is_3 else self.slave.serializeFMUstate
        saved = get()
        content = serialise(saved)
        free(saved)
        return content

    def restore(self, content):
        read = self.slave.deserializeFMUState if self.is_3 else self.slave.deSerializeFMUstate
        put = self.slave.setFMUState if self.is_3 else self.slave.setFMUstate
        free = self.slave.freeFMUState if self.is_3 else self.slave.freeFMUstate
        saved = read(content)
        put(saved)
        free(saved)

    def close(self):
        self.slave.terminate()
        self.slave.freeInstance()


def press(unit):
    """Presses the journal of a contact into its bearing."""
    if "journal_speed_rad_s" in unit.inputs:
        unit.set("journal_z_m", -0.52e-3)
        unit.set("journal_speed_rad_s", 0.5)


def check_fmpy(file):
    """Rows of outputs of a unit in FMPy."""
    remarks = validate_fmu(str(file))
    if remarks:
        raise SystemExit(f"{file}: FMPy remarks: {remarks}")
    unit = Unit(file)
    press(unit)
    rows = [unit.step(i) for i in range(STEPS // 2)]
    content = unit.state()
    rest = [unit.step(i) for i in range(STEPS // 2, STEPS)]
    # The same instance goes back; another one continues from the bytes.
    unit.restore(content)
    again = [unit.step(i) for i in range(STEPS // 2, STEPS)]
    other = Unit(file)
    other.restore(content)
    elsewhere = [other.step(i) for i in range(STEPS // 2, STEPS)]
    if rest != again or rest != elsewhere:
        raise SystemExit(f"{file}: a restored state continues differently")
    names = [v.name for v in unit.outputs]
    unit.close()
    other.close()
    return names, rows + rest


def check_cosim(file, names, expected):
    """Largest difference between libcosimpy and FMPy, relative to each output's largest value."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(step_size=int(STEP_S * 1e9))
    index = execution.add_local_slave(CosimLocalSlave(fmu_path=str(file), instance_name="unit"))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    manipulator = CosimManipulator.create_override()
    execution.add_manipulator(manipulator)
    reference = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
    if "journal_speed_rad_s" in reference:
        wanted = {"journal_z_m": -0.52e-3, "journal_speed_rad_s": 0.5}
        manipulator.slave_real_values(index, [reference[n] for n in wanted], list(wanted.values()))
    found = []
    for _ in range(STEPS):
        execution.step()
        found.append(observer.last_real_values(index, [reference[name] for name in names]))
    largest = 0.0
    for column in range(len(names)):
        scale = max(abs(row[column]) for row in expected) or 1.0
        pairs = zip(found, expected)
        largest = max(largest, max(abs(a[column] - b[column]) / scale for a, b in pairs))
    return largest


def main(files):
    rows = {}
    for file in map(Path, files):
        names, values = check_fmpy(file)
        kind, version = file.stem.rsplit("-", 1)
        rows[kind, version] = values
        line = f"{file.name}: FMPy without remark, state restored to the bit, {len(names)} outputs"
        if version == "2.0":
            difference = check_cosim(file, names, values)
            line += f"; libcosim differs by {difference:.1e}"
            if difference > MAX_DIFFERENCE:
                raise SystemExit(line)
        print(line)
    for kind, version in rows:
        if version == "3.0" and (kind, "2.0") in rows and rows[kind, "2.0"] != rows[kind, version]:
            raise SystemExit(f"{kind}: FMI 2.0 and 3.0 give different values")


if __name__ == "__main__":
    main(sys.argv[1:])
