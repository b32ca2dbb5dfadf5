"""Options of reading and numbering, as the extension takes them."""

from __future__ import annotations

from typing import Any


def options_of(**given: Any) -> dict[str, Any]:
    """The options that were given, as the extension takes them."""
    offset = given.pop("sensor_offset_rad", None)
    options = {name: value for name, value in given.items() if value is not None}
    if isinstance(offset, str):
        if offset != "auto":
            raise ValueError(f"sensor_offset_rad: found {offset!r}, expected rad, or 'auto'")
        options["find_sensor_offset"] = True
    elif offset is not None:
        options["sensor_offset_rad"] = float(offset)
    for name in ("nominal_period_s", "tau0_s"):
        if name in options and not 1e-9 <= float(options[name]) <= 1e9:
            raise ValueError(f"{name}: found {options[name]}, expected 1e-9 to 1e9 s")
    if "flag_width_rad" in options and not 0.0 < float(options["flag_width_rad"]) <= 1.0:
        raise ValueError(
            f"flag_width_rad: found {options['flag_width_rad']}, expected above 0, at most 1 rad"
        )
    if "gravity_share" in options and not -10.0 <= float(options["gravity_share"]) <= 1.5:
        raise ValueError(
            f"gravity_share: found {options['gravity_share']}, expected -10 to 1.5 (1 is gravity)"
        )
    if "gap_probability" in options and not 0.5 <= float(options["gap_probability"]) <= 1.0:
        raise ValueError(
            f"gap_probability: found {options['gap_probability']}, expected 0.5 to 1"
        )
    return options
