"""Pages inside notebooks: recordings, daemons, and the state of a simulation."""

import base64
import html
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

from . import _native

if TYPE_CHECKING:
    from ._client import Session
    from ._recordings import Recording

#: Most bytes of recording in a page that stands inside a notebook.
_MOST_INLINE = 16_000_000


def to_html(
    recording: "Union[str, os.PathLike[str]]", page: "Union[str, os.PathLike[str]]", *, max_bytes: int = 16_000_000
) -> int:
    """Writes a recording as one page that opens from disk, with timeline, forces and deforming surfaces.

    Returns one in how many ticks the page has: 1, unless the recording has more than ``max_bytes``.
    """
    return _native.to_html(Path(recording), Path(page), max_bytes)


class Page:
    """What a notebook shows: it asks for ``_repr_html_``."""

    def __init__(self, frame: str) -> None:
        self._frame = frame

    def _repr_html_(self) -> str:
        return self._frame


def _frame(page: str, width: int, height: int) -> Page:
    """A page inside a frame of its own: its styles and scripts do not touch the notebook's."""
    return Page(
        f'<iframe srcdoc="{html.escape(page, quote=True)}" width="{width}" height="{height}" '
        'sandbox="allow-scripts allow-downloads" style="border:0"></iframe>'
    )


def _show_recording(recording: "Recording", width: int, height: int) -> Page:
    with tempfile.TemporaryDirectory(prefix="palpate-") as directory:
        page = Path(directory) / "page.html"
        _native.to_html(recording.path, page, _MOST_INLINE)
        return _frame(page.read_text("utf-8"), width, height)


def _show_session(session: "Session", width: int, height: int) -> Page:
    url = session.info().get("viewer")
    if not url:
        raise ValueError('this daemon has no page: start it with palpate.serve(…, http="127.0.0.1:0")')
    address = html.escape(url, quote=True)
    return Page(f'<iframe src="{address}" width="{width}" height="{height}" style="border:0"></iframe>')


def _show_simulation(simulation: "_native.Simulation", width: int, height: int) -> Page:
    """The bodies as they stand, drawn as SVG: shaded triangles, farthest first."""
    import numpy as np

    scene = simulation.scene
    # Seen from the side and a little from above.
    view = np.array([[0.8, 0.6, 0.0], [0.18, -0.24, 0.954], [0.5724, -0.7632, -0.3]])
    light = np.array([0.3, -0.5, 0.81])
    corners, shades, depths = [], [], []
    for body in scene.bodies:
        surface = simulation.surface(body)
        mesh = surface.tessellate(tolerance=4e-3 * surface.size)
        triangles = mesh.points[mesh.triangles]
        across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        length = np.linalg.norm(across, axis=1)
        triangles, across = triangles[length > 0.0], across[length > 0.0] / length[length > 0.0, None]
        corners.append(triangles @ view.T)
        shades.append(0.35 + 0.65 * np.abs(across @ light))
        depths.append(corners[-1][:, :, 2].mean(axis=1))
    flat, shade, depth = np.concatenate(corners), np.concatenate(shades), np.concatenate(depths)
    low, high = flat[:, :, :2].min(axis=(0, 1)), flat[:, :, :2].max(axis=(0, 1))
    scale = 0.9 * min(width / max(high[0] - low[0], 1e-9), height / max(high[1] - low[1], 1e-9))
    centre = 0.5 * (low + high)
    shown = (flat[:, :, :2] - centre) * [scale, -scale] + [0.5 * width, 0.5 * height]
    shapes = []
    for k in np.argsort(-depth):
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in shown[k])
        red, green, blue = (int(round(channel * shade[k])) for channel in (214, 137, 122))
        shapes.append(f'<polygon points="{points}" fill="rgb({red},{green},{blue})"/>')
    title = html.escape(f"{scene.name}, tick {simulation.tick}")
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" role="img">'
        f'<title>{title}</title><g stroke-linejoin="round">{"".join(shapes)}</g></svg>'
    )
    data = base64.b64encode(svg.encode()).decode()
    return Page(f'<img alt="{title}" width="{width}" height="{height}" src="data:image/svg+xml;base64,{data}">')
