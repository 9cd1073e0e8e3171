"""Writes the log files of this folder with libraries that are independent of Pintle.

Most files contain the same signals: `time` in s, 0 to 0.99 s at 100 Hz, `angle` in rad and
`force` in N. `expected.csv` contains them as text,
`files.tsv` the names of their columns. The functions `conversions`, `several_times` and
`classes` write what those files leave out. Run with the versions in `requirements.txt`:

    python make.py
"""

import struct
from pathlib import Path

import asammdf
import h5py
import hdf5storage
import nptdms
import numpy as np
import openpyxl
import pandas
import pyarrow
import pyarrow.parquet
import scipy.io

import make_mcap

HERE = Path(__file__).parent
TIME = np.round(np.arange(100) * 0.01, 2)
ANGLE = np.round(0.6 * np.sin(2 * np.pi * 2.0 * TIME), 6)
# Multiples of 1/4, exact in every number type that stores them.
FORCE = np.round(4 * (5000 * np.sign(np.cos(2 * np.pi * 2.0 * TIME)) + 100 * TIME)) / 4
RAW = (4 * FORCE).astype(np.int16)
SIGNALS = {"time": ("s", TIME), "angle": ("rad", ANGLE), "force": ("N", FORCE)}
assert np.array_equal(RAW / 4, FORCE)
# Files with these signals: names of the columns and their units.
FILES = {
    "version-5.mat": (["time", "angle", "force"], ["", "", ""]),
    "version-7.3.mat": (["time", "data.angle", "all(:,3)"], ["", "", ""]),
    "frame.parquet": (["time", "angle", "force"], ["", "", ""]),
    "sheets.xlsx": (["time", "angle", "force"], ["s", "rad", "N"]),
    "mdf-4.10.mf4": (["0/time", "angle", "force"], ["s", "rad", "N"]),
    "mdf-4.10-deflate.mf4": (["0/time", "angle", "force"], ["s", "rad", "N"]),
    "mdf-4.11-transposed.mf4": (["0/time", "angle", "force"], ["s", "rad", "N"]),
    "waveform.tdms": (["wf_time", "angle", "force"], ["s", "rad", "N"]),
    "scaled.tdms": (["time", "angle", "force"], ["s", "rad", "N"]),
    "interleaved.tdms": (["wf_time", "angle", "force"], ["s", "rad", "N"]),
    "big-endian.tdms": (["wf_time", "angle", "force"], ["s", "rad", "N"]),
    "big-endian-interleaved.tdms": (["wf_time", "angle", "force"], ["s", "rad", "N"]),
    "daqmx.tdms": (["wf_time", "angle", "force"], ["s", "", ""]),
    "groups.h5": (["bench/time", "bench/angle", "bench/force"], ["s", "rad", "N"]),
    "matrix.h5": (["log(:,1)", "log(:,2)", "log(:,3)"], ["", "", ""]),
    "table.h5": (["log.time", "log.angle", "log.force"], ["", "", ""]),
    **make_mcap.FILES,
}


def text():
    rows = zip(TIME, ANGLE, FORCE)
    lines = ["time,angle,force", *(f"{t},{a},{f}" for t, a, f in rows)]
    (HERE / "expected.csv").write_text("\n".join(lines) + "\n")


def files():
    rows = ["file", "time", "angle", "force", *(f"unit of {name}" for name in SIGNALS)], *(
        [file, *names, *units] for file, (names, units) in FILES.items()
    )
    (HERE / "files.tsv").write_text("".join("\t".join(row) + "\n" for row in rows))


def mdf():
    linear = asammdf.blocks.v4_blocks.ChannelConversion
    for name, version, compression in [
        ("mdf-4.10.mf4", "4.10", 0),
        ("mdf-4.10-deflate.mf4", "4.10", 1),
        ("mdf-4.11-transposed.mf4", "4.11", 2),
        ("mdf-3.30.mdf", "3.30", 0),
    ]:
        file = asammdf.MDF(version=version)
        angle = asammdf.Signal(ANGLE, TIME, name="angle", unit="rad")
        if version.startswith("4"):
            force = asammdf.Signal(
                RAW, TIME, name="force", unit="N",
                conversion=linear(a=0.25, b=0.0, conversion_type=1),
            )
        else:
            force = asammdf.Signal(FORCE, TIME, name="force", unit="N")
        file.append([angle, force], comment="bench", common_timebase=True)
        # A slower group with its own time.
        slow = asammdf.Signal(np.arange(10.0), TIME[::10], name="temperature", unit="degC")
        file.append([slow], comment="slow", common_timebase=True)
        file.save(HERE / name, overwrite=True, compression=compression)
        np.testing.assert_array_equal(asammdf.MDF(HERE / name).get("force").samples, FORCE)


def tdms():
    waveform = {"wf_increment": 0.01, "wf_start_offset": 0.0, "wf_samples": 1}
    channel = lambda name, data, **more: nptdms.ChannelObject(
        "bench", name, data, properties={"unit_string": SIGNALS[name][0], **waveform, **more}
    )
    with nptdms.TdmsWriter(HERE / "waveform.tdms") as writer:
        for part in [slice(0, 30), slice(30, 60), slice(60, 100)]:
            # The first part has a list of objects, later ones only data.
            writer.write_segment([channel("angle", ANGLE[part]), channel("force", FORCE[part])])
    scale = {
        "NI_Number_Of_Scales": 1,
        "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": 0.25,
        "NI_Scale[0]_Linear_Y_Intercept": 0.0,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
        "NI_Scaling_Status": "unscaled",
    }
    time = nptdms.ChannelObject("bench", "time", TIME, properties={"unit_string": "s"})
    note = nptdms.ChannelObject("notes", "note", ["start", "end"])
    with nptdms.TdmsWriter(HERE / "scaled.tdms") as writer:
        writer.write_segment([time, channel("angle", ANGLE), channel("force", RAW, **scale), note])
    for name, big, interleaved in [
        ("interleaved.tdms", False, True), ("big-endian.tdms", True, False),
        ("big-endian-interleaved.tdms", True, True),
    ]:
        (HERE / name).write_bytes(tdms_segment(big, interleaved))
    (HERE / "daqmx.tdms").write_bytes(tdms_daqmx())
    for name in ["waveform", "scaled", "interleaved", "big-endian", "big-endian-interleaved", "daqmx"]:
        group = nptdms.TdmsFile.read(HERE / f"{name}.tdms")["bench"]
        np.testing.assert_allclose(group["force"][:], FORCE, err_msg=name)


def tdms_text(value, order):
    return struct.pack(order + "I", len(value)) + value.encode()


def tdms_head(order, mask, metadata, raw):
    mask |= 0x40 if order == ">" else 0
    body = struct.pack("<4sI", b"TDSm", mask)
    return body + struct.pack(order + "IQQ", 4713, len(metadata) + len(raw), len(metadata))


def tdms_segment(big, interleaved):
    """Returns a segment with angle and force as doubles, which the library does not write so."""
    order = ">" if big else "<"
    metadata = struct.pack(order + "I", 4)
    for path in ["/", "/'bench'"]:
        metadata += tdms_text(path, order) + struct.pack(order + "II", 0xFFFFFFFF, 0)
    for name in ["angle", "force"]:
        metadata += tdms_text(f"/'bench'/'{name}'", order)
        metadata += struct.pack(order + "IIIQI", 20, 10, 1, len(TIME) // 2, 2)
        metadata += tdms_text("wf_increment", order) + struct.pack(order + "Id", 10, 0.01)
        metadata += tdms_text("unit_string", order) + struct.pack(order + "I", 0x20)
        metadata += tdms_text(SIGNALS[name][0], order)
    chunks = []
    for part in [slice(0, 50), slice(50, 100)]:
        both = np.array([ANGLE[part], FORCE[part]])
        chunks.append((both.T if interleaved else both).astype(order + "f8").tobytes())
    raw = b"".join(chunks)
    return tdms_head(order, 0x0E | (0x20 if interleaved else 0), metadata, raw) + metadata + raw


def tdms_daqmx():
    """Returns a segment as a measuring card streams it: interleaved integers and a scale."""
    metadata = struct.pack("<I", 4)
    for path in ["/", "/'bench'"]:
        metadata += tdms_text(path, "<") + struct.pack("<II", 0xFFFFFFFF, 0)
    angle = np.round(ANGLE / 2e-5).astype(np.int16)
    for position, (name, slope) in enumerate([("angle", 2e-5), ("force", 0.25)]):
        metadata += tdms_text(f"/'bench'/'{name}'", "<")
        # One scaler: int16 in buffer 0 at its offset in the stride; rows of 4 bytes.
        metadata += struct.pack("<IIIQ", 0x1269, 0xFFFFFFFF, 1, len(TIME))
        metadata += struct.pack("<IIIIII", 1, 3, 0, 2 * position, 0, 0)
        metadata += struct.pack("<II", 1, 4)
        properties = [
            ("NI_Number_Of_Scales", 7, struct.pack("<I", 2)),
            ("NI_Scale[1]_Scale_Type", 0x20, tdms_text("Linear", "<")),
            ("NI_Scale[1]_Linear_Slope", 10, struct.pack("<d", slope)),
            ("NI_Scale[1]_Linear_Y_Intercept", 10, struct.pack("<d", 0.0)),
            ("NI_Scale[1]_Linear_Input_Source", 7, struct.pack("<I", 0)),
            ("wf_increment", 10, struct.pack("<d", 0.01)),
        ]
        metadata += struct.pack("<I", len(properties))
        for key, kind, value in properties:
            metadata += tdms_text(key, "<") + struct.pack("<I", kind) + value
    raw = np.array([angle, RAW]).T.astype("<i2").tobytes()
    return tdms_head("<", 0xAE, metadata, raw) + metadata + raw


def hdf5():
    with h5py.File(HERE / "groups.h5", "w") as file:
        group = file.create_group("bench")
        for name, (unit, values) in SIGNALS.items():
            data = group.create_dataset(name, data=values, chunks=(32,), compression="gzip", shuffle=True)
            data.attrs["units"] = unit
        group.create_dataset("slow", data=np.arange(10, dtype=">i4"))
        group.create_dataset("note", data="a text")
    with h5py.File(HERE / "matrix.h5", "w", libver=("earliest", "v114")) as file:
        file.create_dataset("log", data=np.array([TIME, ANGLE, FORCE]).T, compression="lzf")
    with h5py.File(HERE / "table.h5", "w") as file:
        kind = np.dtype([("time", "<f8"), ("angle", ">f8"), ("force", "<f4"), ("count", "<u2")])
        table = np.zeros(100, kind)
        table["time"], table["angle"], table["force"] = TIME, ANGLE, FORCE
        file.create_dataset("log", data=table, chunks=(40,), compression="gzip")


def matlab():
    values = {name: data.reshape(-1, 1) for name, (_, data) in SIGNALS.items()}
    scipy.io.savemat(HERE / "version-5.mat", values, do_compression=True)
    matrix = np.array([TIME, ANGLE, FORCE]).T
    content = {"time": values["time"], "data": {"angle": values["angle"]}, "all": matrix, "note": "a text"}
    (HERE / "version-7.3.mat").unlink(missing_ok=True)
    hdf5storage.savemat(str(HERE / "version-7.3.mat"), content, format="7.3", store_python_metadata=False)


def tables():
    frame = pandas.DataFrame({name: data for name, (_, data) in SIGNALS.items()})
    pyarrow.parquet.write_table(pyarrow.Table.from_pandas(frame), HERE / "frame.parquet")
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = "log"
    sheet.append(list(SIGNALS))
    sheet.append([unit for unit, _ in SIGNALS.values()])
    for row in zip(TIME, ANGLE, FORCE):
        sheet.append([float(value) for value in row])
    notes = book.create_sheet("notes")
    notes.append(["who", "when"])
    notes.append(["a name", "2026-11-27"])
    book.save(HERE / "sheets.xlsx")


def mcap():
    make_mcap.write(TIME, ANGLE, FORCE)


def conversions():
    """Channels of the stored numbers 0 to 99 with every kind of conversion, and other contents."""
    from_dict = asammdf.blocks.conversion_utils.from_dict
    linear = {"a": 0.5, "b": -40.0}
    channels = {
        "linear": from_dict(linear),
        "rational": from_dict({"P1": 0, "P2": 2, "P3": 1, "P4": 0, "P5": 1, "P6": 4}),
        "formula": from_dict({"formula": "X1*2+1"}),
        "root": from_dict({"formula": "sqrt(X)+1"}),
        "unknown": from_dict({"formula": "lookup(X)"}),
        "interpolated": from_dict({"interpolation": True, **table([0, 50, 99], [0, 100, 2])}),
        "nearest": from_dict({"interpolation": False, **table([0, 50, 99], [0, 100, 2])}),
        "status": from_dict({"val_0": 99, "text_0": b"invalid", "default_addr": from_dict(linear)}),
        "words": from_dict({"val_0": 0, "text_0": b"off", "val_1": 1, "text_1": b"on"}),
    }
    stored = np.arange(100, dtype="<u2")
    signals = [
        asammdf.Signal(stored, TIME, name=name, conversion=conversion)
        for name, conversion in channels.items()
    ]
    signals.append(asammdf.Signal((stored / 8).astype("<f2"), TIME, name="half"))
    parts = np.zeros(100, dtype=[("array", "(3,)<f8"), ("axis", "(3,)<f8")])
    signals.append(asammdf.Signal(parts, TIME, name="array"))
    marks = asammdf.InvalidationArray(stored % 10 == 3)
    signals.append(asammdf.Signal(stored, TIME, name="marked", invalidation_bits=marks))
    file = asammdf.MDF(version="4.10")
    file.append(signals, common_timebase=True)
    file.save(HERE / "conversions.mf4", overwrite=True)
    values = lambda name: asammdf.MDF(HERE / "conversions.mf4").get(name).samples
    np.testing.assert_array_equal(values("linear"), 0.5 * stored - 40)
    np.testing.assert_array_equal(values("formula"), 2 * stored + 1)
    np.testing.assert_allclose(values("rational"), (2 * stored + 1) / (stored + 4))
    np.testing.assert_allclose(values("interpolated"), np.interp(stored, [0, 50, 99], [0, 100, 2]))


def table(keys, values):
    raw = {f"raw_{index}": key for index, key in enumerate(keys)}
    return raw | {f"phys_{index}": value for index, value in enumerate(values)}


def several_times():
    """Two groups of equal length with other times: the second 0.5 s later, at half the rate."""
    other = 0.5 + 2 * TIME
    file = asammdf.MDF(version="4.10")
    for name, time in [("a", TIME), ("b", other)]:
        signal = asammdf.Signal(100 * time, time, name=name)
        file.append([signal], acq_name="same", common_timebase=True)
    file.save(HERE / "two-times.mf4", overwrite=True)
    day = np.datetime64("2026-11-27T12:00:00", "us")
    starts = {"a": (day, 0.01, TIME), "b": (day + np.timedelta64(500_000, "us"), 0.02, other)}
    with nptdms.TdmsWriter(HERE / "two-times.tdms") as writer:
        for name, (start, step, time) in starts.items():
            properties = {"wf_start_time": start, "wf_increment": step}
            writer.write_segment([nptdms.ChannelObject("same", name, 100 * time, properties=properties)])
        for name, (start, _, time) in starts.items():
            stamps = start + np.round(1e6 * (time - time[0])).astype("timedelta64[us]")
            writer.write_segment([nptdms.ChannelObject("stamps", name, stamps)])
    # One value of each channel in a segment.
    with nptdms.TdmsWriter(HERE / "fragments.tdms") as writer:
        for index in range(100):
            row = slice(index, index + 1)
            parts = [("angle", ANGLE), ("force", FORCE)]
            writer.write_segment([nptdms.ChannelObject("bench", name, data[row]) for name, data in parts])
    stamps = day + np.round(1e6 * TIME).astype("timedelta64[us]")
    units = ["ms", "us", "ns"]
    columns = {f"stamp_{unit}": pyarrow.array(stamps.astype(f"datetime64[{unit}]")) for unit in units}
    columns["date"] = pyarrow.array(stamps.astype("datetime64[D]"))
    columns["clock"] = pyarrow.array((1000 * TIME).round().astype(np.int32), pyarrow.time32("ms"))
    columns["none"] = pyarrow.array([None] * len(TIME), pyarrow.timestamp("s"))
    table = pyarrow.table({"none": columns.pop("none"), **columns, "force": FORCE})
    pyarrow.parquet.write_table(table, HERE / "stamps.parquet")
    # Waveforms in two segments: one continues, one begins anew after a gap, one changes its rate,
    # one has no start; a spectrum that starts later.
    first, second = slice(0, 50), slice(50, 100)
    with nptdms.TdmsWriter(HERE / "segments.tdms") as writer:
        for part, later in [(first, 0), (second, 500_000)]:
            start = day + np.timedelta64(later, "us")
            again = day + np.timedelta64(20 * later, "us")
            channels = {
                "on": {"wf_start_time": start, "wf_increment": 0.01},
                "again": {"wf_start_time": again, "wf_increment": 0.01},
                "rate": {"wf_start_time": day, "wf_increment": 0.02 if later else 0.01},
                "none": {"wf_increment": 0.01},
                "spectrum": {"wf_start_time": day + np.timedelta64(2, "s"), "wf_increment": 0.25,
                             "wf_xunit_string": "Hz"},
            }
            # Each channel has a group, so that each has its own times.
            writer.write_segment([
                nptdms.ChannelObject(name, name, 100 * TIME[part], properties=properties)
                for name, properties in channels.items()
            ])


def classes():
    """Variables that MATLAB stores with the marks of their class, and others of HDF5."""
    with h5py.File(HERE / "classes.mat", "w", userblock_size=512) as file:
        def variable(name, data, **attributes):
            file.create_dataset(name, data=data)
            for key, value in attributes.items():
                file[name].attrs[key] = np.bytes_(value) if isinstance(value, str) else value

        variable("time", TIME.reshape(1, -1), MATLAB_class="double")
        variable("flag", np.uint8([[0, 1] * 50]), MATLAB_class="logical")
        variable("when", np.uint32([[3_708_000_000, 2, 1, 1, 1, 1]]), MATLAB_class="datetime",
                 MATLAB_object_decode=np.int32(3))
        variable("label", np.uint32([[3_708_000_000, 2, 1, 1, 1, 1]]), MATLAB_class="string")
        z = np.zeros((1, 100), dtype=[("real", "<f8"), ("imag", "<f8")])
        variable("complex", z, MATLAB_class="double")
        sparse = file.create_group("sparse")
        sparse.attrs["MATLAB_class"] = np.bytes_("double")
        sparse.attrs["MATLAB_sparse"] = np.uint64(3)
        sparse.create_dataset("data", data=TIME)
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"
    with open(HERE / "classes.mat", "r+b") as file:
        file.write(head)
    with h5py.File(HERE / "half.h5", "w") as file:
        file.create_dataset("half", data=(np.arange(100) / 8).astype("<f2"))
        # Each group refers to the next ten times.
        for depth in range(12):
            for link in range(10):
                file.require_group(f"g{depth + 1}")
                file.require_group(f"g{depth}")[f"to{link}"] = file[f"g{depth + 1}"]


if __name__ == "__main__":
    for write in [text, files, mdf, tdms, hdf5, matlab, tables, mcap, conversions, several_times, classes]:
        write()
