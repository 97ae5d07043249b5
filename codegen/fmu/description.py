"""The file modelDescription.xml of a unit, and what says how its sources are built.

Functional Mock-up Interface for Model Exchange and Co-Simulation 2.0.4, section 2.2; Functional Mock-up
Interface Specification 3.0.1, section 2.4.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from xml.etree import ElementTree as ET

from codegen.fmu.unit import (
    HELD,
    INDICATOR,
    INPUT,
    OUTPUT,
    PARAMETER,
    RATE,
    STATE,
    TIME,
    Unit,
    Variable,
    plain,
)
from codegen.ir.names import identifier
from codegen.ir.program import OUTPUTS, RATES
from eom.errors import InputError
from eom.units import read

BASE = {"mass": "kg", "length": "m", "time": "s", "current": "A", "temperature": "K",
        "amount": "mol", "intensity": "cd"}  # fmt: skip
"""Attributes of FMI by the exponents of `eom.units.Dimension`."""
ROLES: Mapping[str, Mapping[str, str]] = {
    TIME: {"causality": "independent", "variability": "continuous"},
    STATE: {"causality": "output", "variability": "continuous", "initial": "exact"},
    RATE: {"causality": "local", "variability": "continuous", "initial": "calculated"},
    PARAMETER: {"causality": "parameter", "variability": "tunable", "initial": "exact"},
    INPUT: {"causality": "input", "variability": "continuous"},
    HELD: {"causality": "local", "variability": "discrete", "initial": "calculated"},
    OUTPUT: {"causality": "output", "variability": "continuous", "initial": "calculated"},
    "invariant": {"causality": "local", "variability": "continuous", "initial": "calculated"},
    INDICATOR: {"causality": "local", "variability": "continuous", "initial": "calculated"},
}
"""What kinds of variables are in FMI."""
CATEGORIES = {
    "logStatusError": "a call that is not carried out",
    "logStatusDiscard": "a value that is not finite",
}


def of_version_2(unit: Unit, token: str, sources: Iterable[str]) -> str:
    """Return modelDescription.xml of FMI 2.0; ``token``: the guid."""
    root = _root(unit, "2.0", "guid", token)
    root.set("numberOfEventIndicators", str(len(unit.of(INDICATOR))))
    files = sorted(sources)
    flags = dict.fromkeys(
        ("canNotUseMemoryManagementFunctions", "canGetAndSetFMUstate", "canSerializeFMUstate",
         "providesDirectionalDerivative"), "true"
    )  # fmt: skip
    for kind in ("ModelExchange", "CoSimulation"):
        further = {"canHandleVariableCommunicationStepSize": "true"} if kind[0] == "C" else {}
        part = ET.SubElement(root, kind, {"modelIdentifier": _name(unit), **flags, **further})
        listed = ET.SubElement(part, "SourceFiles")
        for name in files:
            ET.SubElement(listed, "File", name=name)
    _shared(unit, root)
    variables = ET.SubElement(root, "ModelVariables")
    for v in unit.variables:
        if v.kind != INDICATOR:
            row = ET.SubElement(variables, "ScalarVariable", _attributes(v))
            of = {"derivative": str(_state_of(unit, v) + 1)} if v.kind == RATE else {}
            ET.SubElement(row, "Real", {**_measure(v), **of})
    _structure_2(unit, root)
    return _text(root)


def of_version_3(unit: Unit, token: str) -> str:
    """Return modelDescription.xml of FMI 3.0; ``token``: the instantiation token."""
    root = _root(unit, "3.0", "instantiationToken", token)
    flags = dict.fromkeys(
        ("canGetAndSetFMUState", "canSerializeFMUState", "providesDirectionalDerivatives",
         "providesAdjointDerivatives"), "true"
    )  # fmt: skip
    flags["modelIdentifier"] = _name(unit)
    ET.SubElement(root, "ModelExchange", flags)
    ET.SubElement(root, "CoSimulation", {**flags, "canHandleVariableCommunicationStepSize": "true"})
    _shared(unit, root)
    variables = ET.SubElement(root, "ModelVariables")
    for v in unit.variables:
        of = {"derivative": str(_state_of(unit, v))} if v.kind == RATE else {}
        ET.SubElement(variables, "Float64", {**_attributes(v), **_measure(v), **of})
    _structure_3(unit, root)
    return _text(root)


def build(unit: Unit, sources: Iterable[str]) -> str:
    """Return sources/buildDescription.xml of FMI 3.0."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    part = ET.SubElement(root, "BuildConfiguration", modelIdentifier=_name(unit))
    listed = ET.SubElement(part, "SourceFileSet", language="C99")
    for name in sorted(sources):
        ET.SubElement(listed, "SourceFile", name=name)
    return _text(root)


def _name(unit: Unit) -> str:
    return identifier(unit.compiled.layout.name)


def _state_of(unit: Unit, rate: Variable) -> int:
    return unit.of(STATE)[rate.number].reference


def _root(unit: Unit, version: str, key: str, token: str) -> ET.Element:
    layout = unit.compiled.layout
    return ET.Element("fmiModelDescription", {
        "fmiVersion": version, "modelName": plain(layout.name), key: token,
        "description": plain(layout.title), "generationTool": "eom", "variableNamingConvention": "flat",
    })  # fmt: skip


def _shared(unit: Unit, root: ET.Element) -> None:
    """Write units, categories of messages and the default experiment."""
    units = ET.SubElement(root, "UnitDefinitions")
    for name in dict.fromkeys(v.unit or "1" for v in unit.variables):
        row = ET.SubElement(units, "Unit", name=name)
        powers = _powers(name)
        if powers is not None:
            ET.SubElement(row, "BaseUnit", powers)
    categories = ET.SubElement(root, "LogCategories")
    for name, meaning in CATEGORIES.items():
        ET.SubElement(categories, "Category", name=name, description=meaning)
    start, end = unit.t_span
    ET.SubElement(root, "DefaultExperiment", startTime=repr(start), stopTime=repr(end),
                  tolerance=repr(unit.rtol))  # fmt: skip


def _powers(name: str) -> dict[str, str] | None:
    """Return the exponents of the units of FMI; None where the text is no unit of SI, or has fractions."""
    try:
        found = read(name)
    except InputError:
        return None
    powers = {BASE[k]: v for k, v in found.dimension._asdict().items() if v}
    powers |= {n: v for n, v in found.si if n == "rad"}
    if not found.is_coherent or any(v.denominator != 1 for v in powers.values()):
        return None
    return {n: str(v) for n, v in powers.items()}


def _attributes(v: Variable) -> dict[str, str]:
    meaning = {"description": v.meaning} if v.meaning else {}
    return {"name": v.name, "valueReference": str(v.reference), **meaning, **ROLES[v.kind]}


def _measure(v: Variable) -> dict[str, str]:
    start = {"start": repr(v.start)} if v.start is not None and v.kind != HELD else {}
    return {"unit": v.unit or "1", **start}


def _unknowns(unit: Unit) -> dict[str, list[tuple[Variable, tuple[int, ...]]]]:
    """Return outputs and derivatives with the value references that they depend on."""
    states = [(v, (v.reference,)) for v in unit.of(STATE)]
    outputs = [(v, unit.dependencies(OUTPUTS, v.number)) for v in unit.of(OUTPUT)]
    rates = [(v, unit.dependencies(RATES, v.number)) for v in unit.of(RATE)]
    return {"outputs": [*states, *outputs], "rates": rates, "calculated": [*outputs, *rates]}


def _structure_2(unit: Unit, root: ET.Element) -> None:
    """Write the structure by places of variables, from one."""
    structure, found = ET.SubElement(root, "ModelStructure"), _unknowns(unit)
    titles = {"Outputs": "outputs", "Derivatives": "rates", "InitialUnknowns": "calculated"}
    for title, key in titles.items():
        if found[key]:
            part = ET.SubElement(structure, title)
            for v, needs in found[key]:
                listed = (
                    {"dependencies": _listed(k + 1 for k in needs)} if key != "calculated" else {}
                )
                ET.SubElement(part, "Unknown", {"index": str(v.reference + 1), **listed})


def _structure_3(unit: Unit, root: ET.Element) -> None:
    """Write the structure by value references."""
    structure, found = ET.SubElement(root, "ModelStructure"), _unknowns(unit)
    titles = {
        "Output": "outputs",
        "ContinuousStateDerivative": "rates",
        "InitialUnknown": "calculated",
    }
    for title, key in titles.items():
        for v, needs in found[key]:
            listed = {"dependencies": _listed(needs)} if key != "calculated" else {}
            ET.SubElement(structure, title, {"valueReference": str(v.reference), **listed})
    for v in unit.of(INDICATOR):
        ET.SubElement(structure, "EventIndicator", valueReference=str(v.reference))


def _listed(numbers: Iterable[int]) -> str:
    return " ".join(map(str, numbers))


def _text(root: ET.Element) -> str:
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"
