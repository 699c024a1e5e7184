"""Constants that Python and TypeScript share, written from spec/constants.json by `make constants`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# ---- pressure of the wind ----------------------------------------------------------------------------------

HALF_AIR_DENSITY_KG_M3 = 0.6
"""Dynamic pressure over speed squared up to the streamlining speed; the air has 1.2 kg/m³ [Pa·s²/m²]."""
STREAMLINING_SPEED_M_S = 5.0
"""Above this speed the pressure grows with the streamlined exponent of the tree (metadata of the table)
[m/s].
"""
STREAMLINING_PRESSURE_PA = 15.0
"""Dynamic pressure at the streamlining speed [Pa]."""
PRESSURE_COMPRESSION = 0.25
"""Pressures beyond the sampled range are compressed: 2 times the range to 1.40, 5 times to 1.71."""

# ---- wind document -----------------------------------------------------------------------------------------

WIND_VERSION = 1
"""Version of the wind document."""
WIND_MODELS = ("cosine", "perlin", "spectral", "navier-stokes", "recorded")
"""Models of the gusts."""
TIMED_MODELS = ("cosine", "recorded")
"""Models that depend on the time rather than on the distance travelled."""
WIND_FIELDS: Mapping[str, Any] = {
    "mean_speed_m_s": {"low": 0.0, "high": 60.0},
    "direction_deg": {"low": -360.0, "high": 360.0},
    "gustiness": {"low": 0.0, "high": 1.0},
    "convection_speed_m_s": {"low": 0.5, "high": 60.0},
    "seed": {"low": 0.0, "high": 4294967295.0, "whole": True},
    "length_scale_m": {"low": 5.0, "high": 200.0, "models": ("perlin", "spectral", "navier-stokes")},
    "beta": {"low": 0.0, "high": 2.0, "models": ("spectral",), "default": 1.6666666666666667},
    "height_exponent": {"low": 0.0, "high": 1.0, "default": 0.2},
    "reference_height_m": {"low": 1.0, "high": 60.0, "default": 12.0},
    "heading_swing_deg": {"low": 0.0, "high": 60.0, "models": ("cosine",), "default": 12.0},
}
"""Numbers of a wind document: range, the models that have the field (without it: all), and the default
(without it: required).
"""
WIND_LISTS: Mapping[str, Any] = {
    "cosine": ("waves",),
    "recorded": ("recording",),
}
"""Fields of a wind document that are not numbers, by model."""
UNUSED_LENGTH_SCALE_M = 20.0
"""Length scale wherever one is needed for a model that has none [m]."""
MOST_WAVES = 16
"""Most waves of a cosine document."""
WAVE_FIELDS: Mapping[str, Any] = {
    "frequency_hz": {"low": 0.001, "high": 4.0},
    "share": {"low": 0.0, "high": 1.0},
    "across": {"low": -2.0, "high": 2.0, "default": 0.0},
    "phase_turns": {"low": 0.0, "high": 1.0, "default": -1.0},
}
"""Numbers of a wave; a negative phase derives it from the seed."""
WAVE_SHARE_TOLERANCE = 1e-9
"""By how much the sum of the shares may exceed 1."""
FOREST_WAVES = (
    {"frequency_hz": 0.05, "share": 0.262, "across": 0.6},
    {"frequency_hz": 0.087, "share": 0.218, "across": -0.45},
    {"frequency_hz": 0.152, "share": 0.181, "across": 0.75},
    {"frequency_hz": 0.264, "share": 0.15, "across": -0.6},
    {"frequency_hz": 0.46, "share": 0.105, "across": 0.5},
    {"frequency_hz": 0.8, "share": 0.084, "across": -0.7},
)
"""Waves of a cosine document without its own. The amplitudes decrease roughly as f^(−1/3), as a −5/3 power
spectrum requires, and sum to one. `across` is the wavenumber across the wind relative to that along it;
alternating signs make the gusts cross.
"""
RECORDING_FIELDS: Mapping[str, Any] = {
    "interval_s": {"low": 0.05, "high": 3600.0},
    "unit": {"low": 0.0, "high": 1000.0},
}
"""Numbers of a recording: interval of its samples, and the fluctuation that one count stands for."""
FEWEST_RECORDING_SAMPLES = 2
"""Fewest samples of a recording."""
MOST_RECORDING_SAMPLES = 6000
"""Ten minutes at 10 Hz: 32 kB of text, so that a state with three documents stays below 100 kB."""
STILL_RECORDING: Mapping[str, Any] = {"interval_s": 1.0, "unit": 0.0, "pairs": "AAAAAAAAAAA="}
"""The recording of a wind without fluctuations."""
WIND_PRESETS: Mapping[str, Any] = {
    "still": {
        "version": 1,
        "model": "spectral",
        "direction_deg": 30.0,
        "seed": 1,
        "mean_speed_m_s": 0.0,
        "gustiness": 0.6,
        "convection_speed_m_s": 2.0,
        "length_scale_m": 28.0,
    },
    "breeze": {
        "version": 1,
        "model": "perlin",
        "direction_deg": 30.0,
        "seed": 1,
        "mean_speed_m_s": 4.0,
        "gustiness": 0.4,
        "convection_speed_m_s": 4.0,
        "length_scale_m": 18.0,
    },
    "autumn-gusts": {
        "version": 1,
        "model": "spectral",
        "direction_deg": 30.0,
        "seed": 1,
        "mean_speed_m_s": 9.0,
        "gustiness": 0.75,
        "convection_speed_m_s": 10.0,
        "length_scale_m": 28.0,
    },
    "storm-front": {
        "version": 1,
        "model": "navier-stokes",
        "direction_deg": 30.0,
        "seed": 1,
        "mean_speed_m_s": 20.0,
        "gustiness": 0.9,
        "convection_speed_m_s": 16.0,
        "length_scale_m": 34.0,
    },
}
"""Named winds of the forest page."""
PAPER_WAVES = (
    (0.3, 0.5, 4.0, 0.5),
    (0.45, 0.9, 3.0, 0.5),
    (0.6, 0.3, 6.0, 0.6),
    (0.75, 0.7, 2.5, 0.45),
    (0.9, 0.3, 5.0, 0.55),
    (1.0, 0.8, 3.5, 0.5),
)
"""Peak speed over design speed, depth (U = peak (1 + depth cos) / (1 + depth)), period in s and phase in
turns of the paper's six cosine winds. The paper shows them only in a figure without numbers; these span
the same range.
"""

# ---- state of a wind ---------------------------------------------------------------------------------------

TRANSITION_S = 0.6
"""Time in which a change of the wind is interpolated from the old document to the new one [s]."""
MOST_FRONTS = 4
"""Most gust fronts at once; a further one replaces the oldest."""
FRONT_LIFE_S = 30.0
"""A front is forgotten after this time [s]."""
FRONT_DEPTH_M = 14.0
"""Half the extent of a front along the wind [m]."""
FRONT_WIDTH_M = 16.0
"""Half the width of a front at the start [m]."""
FRONT_SPREAD = 0.35
"""By how much that grows per metre travelled [m/m]."""
FRONT_RANGE_M = 180.0
"""Distance after which a front has died down [m]."""
FRONT_RISE_S = 0.6
"""Time in which a front reaches its strength [s]."""
FRONT_LEAST_GUST_M_S = 6.0
"""Speed that a front adds in still air [m/s]."""
FRONT_GUST_SHARE = 0.8
"""Further speed that it adds, over the mean speed."""
FRONT_LEAST_TRAVEL_M_S = 9.0
"""Least speed at which a front travels [m/s]."""
FRONT_TRAVEL_SHARE = 1.2
"""Speed at which it travels over the mean speed."""
FRONT_LIMITS: Mapping[str, Any] = {
    "since_s": (-1e9, 1e9),
    "x_m": (-1e6, 1e6),
    "z_m": (-1e6, 1e6),
    "direction_deg": (-360.0, 360.0),
    "mean_speed_m_s": (0.0, 60.0),
}
"""Numbers of a front and their ranges."""

# ---- hashes of the wind ------------------------------------------------------------------------------------

HASH_GOLDEN = 2654435769
"""0x9E3779B9, 2³² over the golden ratio: spreads the index of a hash."""
HASH_FACTOR = 73244475
"""0x45D9F3B, the factor of Mueller's integer finaliser."""
HASH_TURN_RAD = 1.4629180792671596e-9
"""2π / 2³²: a hash times this is an angle [rad]."""

# ---- gusts of a forest -------------------------------------------------------------------------------------

TURBULENCE_PER_GUSTINESS = 0.308
"""Standard deviation of the speed over its mean at gustiness 1, as produced by the cosine model."""
COSINE_HEADING_HZ = 0.03
"""Frequency with which the heading oscillates [Hz]."""
COSINE_HEADING_PHASE = 6
"""Index of the phase used for this oscillation."""
PERLIN_EDGES = (
    (1, 1, 0),
    (-1, 1, 0),
    (1, -1, 0),
    (-1, -1, 0),
    (1, 0, 1),
    (-1, 0, 1),
    (1, 0, -1),
    (-1, 0, -1),
    (0, 1, 1),
    (0, -1, 1),
    (0, 1, -1),
    (0, -1, -1),
    (1, 1, 0),
    (0, -1, 1),
    (-1, 1, 0),
    (0, -1, -1),
)
"""Gradient directions: from the centre of a cube to its twelve edges, four of them twice."""
PERLIN_NOISE_VARIANCE = 0.07291894569119509
"""35054270/480729249 = 16 A² B with A = ∫(1−f)², B = ∫(1−f)² t², f the fade 6t⁵ − 15t⁴ + 10t³, over [0, 1].
"""
PERLIN_LATERAL_SHARE = 0.5
"""Fluctuation across the wind over that along it."""
PERLIN_CELLS_PER_SCALE = 0.5
"""A lattice cell of the first octave spans two length scales."""
PERLIN_GAIN = 0.6
"""Amplitude of an octave over that of the octave before it."""
PERLIN_OCTAVES = 3
"""Octaves along the wind; there is one across it."""
PERLIN_SLANT = 0.17
"""Lateral drift: the noise is zero at its lattice points, and no tree should stay on a lattice line."""
PERLIN_CHANGE = 0.1
"""Evolution of the noise, in lattice cells per length scale travelled."""
SPECTRAL_COLUMNS = 1024
"""Grid cells of the field along the wind: 64 length scales."""
SPECTRAL_ROWS = 128
"""Grid cells of the field across the wind: 32 length scales."""
SPECTRAL_CELLS_ALONG = 16
"""Grid cells per length scale along the wind."""
SPECTRAL_CELLS_ACROSS = 4
"""Grid cells per length scale across the wind."""
SPECTRAL_LATERAL_SHARE = 0.5
"""Fluctuation across the wind over that along it."""
SPECTRAL_SLANT = 0.0955
"""Lateral drift: about 0.382 field widths per field length, which spreads successive passes over a tree
evenly.
"""
SPECTRAL_VON_KARMAN = 70.8
"""Factor of n² in von Kármán's spectrum (ESDU 85020)."""
SPECTRAL_DECAY = 7.0
"""Davenport's decay constant across the wind."""
SPECTRAL_SLOWEST_COHERENCE = 0.15
"""The width of the slowest gusts is limited to that of this reduced frequency n."""
EDDY_GRID = 128
"""Cells per side of the grid of the eddies: 25.6 length scales."""
EDDY_CELLS_PER_SCALE = 5
"""Grid cells per length scale."""
EDDY_CELLS_PER_STEP = 0.5
"""Distance in cells that air at one standard deviation moves per step."""
EDDY_STEPS_PER_SCALE = 0.5
"""Solver steps per length scale travelled by the air; air at one standard deviation moves a tenth of a scale
per step. Gusts thus stay coherent while they cross the forest. At six times this rate, the time of best
correlation between two places is 5 % early.
"""
EDDY_BAND = (4, 7)
"""Wavenumbers that are forced: at least the first and below the second number of waves across the grid."""
EDDY_KICK = 0.06
"""Forcing per step, approximately relative to the amplitude."""
EDDY_FRICTION = 0.01
"""Friction per step."""
EDDY_LARGE_SCALE_FRICTION = 0.5
"""Friction F / k² that opposes the inverse cascade, which would otherwise end in one pair of eddies."""
EDDY_SLOWEST_START = 3
"""Smallest wavenumber of the field that a run starts from."""
EDDY_EPOCH = 128
"""Steps after which the next run of the solver starts."""
EDDY_OVERLAP = 32
"""Steps in which consecutive runs are cross-faded."""
EDDY_LATERAL_SHARE = 1.0
"""Equal along and across the wind, as in any isotropic divergence-free field."""
RECORDED_LATERAL_SHARE = 1.0
"""A recording holds both components in the same unit."""

# ---- gusts within a crown ----------------------------------------------------------------------------------

CROWN_CELLS = 64
"""Cells per side of the field, which repeats after 48 m."""
CROWN_CELL_M = 0.75
"""Side of a cell [m]."""
CROWN_FEWEST_PERIODS = 4
"""Periods of the longest waves, of 12 m, per field width."""
CROWN_MOST_PERIODS = 16
"""Periods of the shortest waves, of 3 m, per field width."""
CROWN_WAVES = 48
"""Plane waves of the field."""
CROWN_INTENSITY = 0.6
"""Standard deviation of each component over the mean speed, for a gustiness of 1. Assumed. Near the top of a
canopy the turbulence intensity is about 0.5, and larger below (Raupach, Finnigan & Brunet 1996;
unchecked); the gust models provide 0.3 at this gustiness.
"""
CROWN_LEAN_ALONG = -0.6
"""Shift of the field along the wind per metre of height: gusts reach the top first [m/m]."""
CROWN_LEAN_ACROSS = 0.8
"""Shift of the field across the wind per metre of height [m/m]."""
CROWN_SLANT = 0.191
"""Lateral drift, so that the periodic field does not return to the same tree."""
CROWN_MOST_GUST = 0.9
"""Limit of the relative speed of a gust, which keeps the wind from turning back."""

# ---- table file --------------------------------------------------------------------------------------------

TABLE_FORMAT = "galewood-table"
"""Field `format` of a table's metadata."""
TABLE_VERSION = 1
"""Version of the table file."""
MAX_TABLE_HEADER_BYTES = 1048576
"""Longest header of a table, records or compliance file [bytes]."""
MAX_MODES = 256
"""Most modes of a table."""
MAX_OSCILLATORS = 64
"""Most oscillators of the modal model."""
MAX_DRAG_POINTS = 32
"""Most drag points of the modal model."""
MAX_PLACES = 32
"""Most places of the crown whose gusts drive the modal model."""
TABLE_RANGES: Mapping[str, Any] = {
    "height_m": (0.01, 1000.0),
    "dt_s": (0.0001, 1.0),
    "design_speed_m_s": (0.0, 100.0),
    "streamlined_exponent": (1.0, 2.0),
    "peak_pressure_pa": (0.0, 1e9),
    "reach_m": (0.0, 10000.0),
}
"""Numbers of a table's metadata and their ranges."""
TABLE_TENSORS: Mapping[str, Any] = {
    "modes.scale": ("F32", 1),
    "nodes.basis": ("F32", 3),
    "nodes.rest_m": ("F32", 2),
    "nodes.turn": ("F32", 3),
    "nodes.parent": ("U16", 1),
    "joints.nodes": ("U16", 2),
    "joints.share": ("F32", 1),
    "joints.rest_m": ("F32", 2),
    "render.vertex_joint": ("U16", 1),
    "modal.step": ("F32", 2),
    "modal.load": ("F32", 2),
    "modal.sway": ("F32", 2),
    "modal.force": ("F32", 2),
    "modal.shown": ("F32", 1),
    "modal.pose": ("F32", 2),
    "modal.limits": ("F32", 1),
    "modal.drag_point": ("F32", 2),
    "modal.drag_shape": ("F32", 3),
    "modal.drag_rest": ("F32", 1),
    "modal.drag_place": ("F32", 2),
    "modal.place": ("F32", 2),
    "modal.place_load": ("F32", 3),
}
"""Type and rank of the tensors of a table."""
RECORDS_FORMAT = "galewood-records"
"""Field `format` of a records file's metadata."""
RECORDS_VERSION = 1
"""Version of the records file."""
RECORD_TENSORS: Mapping[str, Any] = {
    "samples.dq": ("I16", 2),
    "samples.pressure_pa": ("F32", 2),
    "samples.trajectory": ("U32", 1),
    "search.offsets": ("U32", 1),
    "search.record": ("U16", 1),
    "search.mismatch_steps": ("U16", 1),
}
"""Type and rank of the tensors of the paper's records, in a table or in a file of their own."""

# ---- compliance file ---------------------------------------------------------------------------------------

COMPLIANCE_FORMAT = "galewood-compliance"
"""Field `format` of a compliance file's metadata."""
COMPLIANCE_VERSION = 1
"""Version of the compliance file."""
MAX_COMPLIANCE_NODES = 65534
"""Most free nodes of the solid."""
BINDING_CORNERS = 4
"""Points of the solid that a vertex of the render mesh follows."""
WHOLE_WEIGHT = 65535
"""Sum of the weights of a row of the binding."""
COMPLIANCE_TENSORS: Mapping[str, Any] = {
    "factor.pointer": ("U32", 1),
    "factor.rows": ("U16", 1),
    "factor.blocks": ("F32", 2),
    "nodes.mass_kg": ("F32", 1),
    "nodes.limit_n": ("F32", 1),
    "bind.node": ("U16", 2),
    "bind.weight": ("U16", 2),
    "bind.vertex_row": ("U32", 1),
}
"""Type and rank of the tensors of a compliance file."""

# ---- modal model -------------------------------------------------------------------------------------------

MAX_STEPS_PER_ADVANCE = 8
"""Most steps of one call: after a long pause a tree resumes instead of catching up."""
MODAL_REACH = 1.25
"""The arguments of the polynomials are clamped to this multiple of the sampled range. The force stays
bounded, and as the linear step contracts, any bounded wind gives a bounded motion.
"""
MOST_TERM_SUMS = 4
"""Most sums that take the place of the terms of a force, if these drive the oscillators in so few ways."""
TERM_SUM_ROUNDING = 2.384185791015625e-7
"""What the sums leave of a term's numbers, over the largest of them, when it is their rounding."""
MODAL_REST = 1e-7
"""In still air a motion below this share of the sampled range is set to exactly zero."""
FEWEST_DRAG_INPUTS = 8
"""Fewest oscillators whose speed determines the velocity of the drag points; otherwise half of them."""
ISOTROPIC_DRAG = 1.3333333333333333
"""4/3: mean over all directions of the derivative of a quadratic drag, over pressure per speed."""

# ---- drawn vertices ----------------------------------------------------------------------------------------

LONGEST_LINK = 1.02
"""Length of a link between nodes, relative to rest, from which it is shortened."""
MOST_LINK_STRETCH = 2.0
"""Stretch of a link up to which it is taken off the rotation: that of a linear motion at an angle of 60°."""
TURN_ARM = 0.02
"""Arm at which rotation counts as displacement where nodes are chosen or merged, relative to the height."""

# ---- inventory document ------------------------------------------------------------------------------------

INVENTORY_VERSION = 1
"""Version of the inventory document."""

# ---- state search ------------------------------------------------------------------------------------------

SEARCH_ANY_AIR = -1
"""Search the records of moving air (0), of still air (1), or these: all."""
SEARCH_SNAP = 0.5
"""Pose easing snaps to the record's pose once the offset and its speed are below half an integer step."""
EXPONENTIAL_TERMS = 12
"""Terms of the Taylor series of exp(−t) for small t."""
EXPONENTIAL_SQUARINGS = 8
"""Its argument is divided by 2 to this power, and the result squared as often."""

# ---- pulling -----------------------------------------------------------------------------------------------

PULL_STRETCH_SHARE = 0.12
"""Directions in which a point yields less than this share of its mean barely move."""
PULL_LAG_S = 0.05
"""Time constant with which the force follows the target [s]."""
PULL_MOST_REACH = 0.15
"""Largest displacement by pulling, relative to the height."""
PULL_FORCE_SHARE = 0.4
"""Largest pulling force over the breaking force: up to it a linear response is off by about 2 % at most."""
PULL_SAME_PLACE_M = 0.05
"""A pull at this distance from a tree's place means that tree [m]."""
PULL_EASE_S = 0.7
"""Time in which a tree of the paper's method, which has no oscillators, returns after a release [s]."""

# ---- wire protocol -----------------------------------------------------------------------------------------

WIRE_VERSION = 1
"""Version of the wire protocol."""
WIRE_MAGIC = "GW"
"""First bytes of every message."""
WIRE_PREFIX_BYTES = 8
"""What precedes the header: magic, version, kind, length [bytes]."""
WIRE_MAX_HEADER_BYTES = 131072
"""Longest header: room for a state with three recorded winds [bytes]."""
TICK_HZ = 30
"""Frames per second of a stream and ticks per second of a forest's clock [Hz]."""
WIRE_HELLO = 1
"""Kind of message, from a client: its name."""
WIRE_FOREST = 2
"""Kind of message, from a client: requests a forest."""
WIRE_WIND = 3
"""Kind of message, from a client: changes the wind."""
WIRE_PING = 4
"""Kind of message, from a client: requests PONG."""
WIRE_PAUSE = 5
"""Kind of message, from a client: stops or resumes the clock."""
WIRE_RESYNC = 6
"""Kind of message, from a client: requests a key frame."""
WIRE_PULL = 7
"""Kind of message, from a client: a hand moves a vertex."""
WIRE_RELEASE = 8
"""Kind of message, from a client: a hand lets go."""
WIRE_GUST = 9
"""Kind of message, from a client: starts a gust front."""
WIRE_WELCOME = 65
"""Kind of message, from the server: the reply to HELLO."""
WIRE_TABLE = 66
"""Kind of message, from the server: a piece of a table file."""
WIRE_FRAME = 67
"""Kind of message, from the server: poses."""
WIRE_ERROR = 68
"""Kind of message, from the server: why it closes the connection."""
WIRE_PONG = 69
"""Kind of message, from the server: the reply to PING."""
WIRE_WIND_STATE = 70
"""Kind of message, from the server: the state of the wind."""
WIRE_CLOCK = 71
"""Kind of message, from the server: the time of the forest."""
WIRE_SHARED = 72
"""Kind of message, from the server: describes a shared forest."""
WIRE_PULLS = 73
"""Kind of message, from the server: who pulls what."""
WIRE_PRESENCE = 74
"""Kind of message, from the server: how many clients share the forest."""
FOREST_OPTIONS = ("pose_easing", "method", "share", "replant", "about", "have")
"""Optional fields of FOREST."""
MOST_STREAMED_TREES = 20000
"""Most trees of a forest that a server steps, unless it is set otherwise; larger ones are played by their
clients.
"""
MOST_ABOUT_ENTRIES = 32
"""Most entries in a forest's `about`."""
MOST_PULLS_OF_FOREST = 32
"""Most pulls of one forest."""
PULL_PLACE_M = 1e6
"""Largest coordinate of a place [m]."""
PULL_TARGET_M = 1000.0
"""Largest component of a target, a displacement from rest [m]."""
PULL_FORCE_N = 1e9
"""Largest component of a pulling force [N]."""

# ---- build -------------------------------------------------------------------------------------------------

RECORDS_STAGE = "records"
"""Stage of a build that computes the paper's records."""
STAGES_AFTER_TABLE = ("records", "bare")
"""Stages after the complete table of the default method; the last computes the bare table."""
LINEAR_SWAY_SHARE = 0.2
"""Sway over height beyond which the linear response overestimates."""

# ---- trees -------------------------------------------------------------------------------------------------

BREAST_HEIGHT_M = 1.3
"""Height at which the diameter of a trunk is measured [m]."""

# ---- levels of detail --------------------------------------------------------------------------------------

LEVEL_SHARES = (1.0, 0.5, 0.25, 0.13, 0.07)
"""Share of the leaves and twigs that each level of detail shows."""
SHRINK_RANK_WIDTH = 0.2
"""A piece shrinks while its rank is between the share and (1 + this) times the share."""
MOST_LEAF_GROWTH = 2.4
"""Remaining leaves grow to keep the area of the crown, up to this factor: larger ones look like no leaves."""
BRANCH_FOOT_WEIGHT = 0.3
"""The foot of a branch is its vertex of the least horizontal distance from the trunk plus this times its
height.
"""
RANK_SALT = 11
"""Second number of the hash by which leaves are ranked."""
