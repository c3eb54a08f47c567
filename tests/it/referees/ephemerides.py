"""Reads ours.oem and ours.xml in a folder with the package oem (Orbital Ephemeris Message), writes what it read as theirs.oem and theirs.xml,
and states between rows (km, km/s; four moments of each file) to states.f64. With ccsds-ndm, ours_aem.xml becomes theirs_aem.xml."""

import pathlib
import struct
import sys

from astropy.time import TimeDelta
from oem import OrbitEphemerisMessage

folder = pathlib.Path(sys.argv[1])
numbers = []
for ending in ["oem", "xml"]:
    message = OrbitEphemerisMessage.open(folder / f"ours.{ending}")
    segment = next(iter(message.segments))
    for second in [450.0, 1001.0, 2222.0, 3333.0]:
        state = segment(segment.useable_start_time + TimeDelta(second, format="sec"))
        numbers += [*state.position, *state.velocity]
    message.save_as(folder / f"theirs.{ending}", file_format="kvn" if ending == "oem" else "xml")
(folder / "states.f64").write_bytes(struct.pack(f"<{len(numbers)}d", *numbers))

try:
    from ccsds_ndm.mapping import NDMFileFormats
    from ccsds_ndm.ndm_io import NdmIo
except ImportError:
    sys.exit()
attitude = NdmIo().from_path(folder / "ours_aem.xml")
(folder / "theirs_aem.xml").write_text(NdmIo().to_string(attitude, NDMFileFormats.XML))
