"""glTF documents of the tests' own."""

import base64
import io
import json
import struct

import numpy as np
from PIL import Image

from pylmc.scene.loading import load

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
AUTO = {"auto_camera": True, "auto_light": True}
TYPES = {"f": 5126, "H": 5123, "B": 5121, "h": 5122}


class Builder:
    """Puts a glTF document together, arrays in one buffer."""

    def __init__(self, **document):
        self.binary = b""
        self.document = {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "accessors": [],
            "bufferViews": [],
            **document,
        }

    def view(self, content, **more):
        self.binary += b"\0" * (-len(self.binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content), **more}
        self.document["bufferViews"].append(view)
        self.binary += content
        return len(self.document["bufferViews"]) - 1

    def array(self, values, **more):
        values = np.asarray(values)
        accessor = {
            "bufferView": self.view(values.tobytes()),
            "componentType": TYPES[values.dtype.char],
            "count": len(values),
            "type": "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
            **more,
        }
        self.document["accessors"].append(accessor)
        return len(self.document["accessors"]) - 1

    def square(self, indexed=True, material=None, **attributes):
        positions = SQUARE if indexed else SQUARE[[0, 1, 2, 0, 2, 3]]
        primitive = {"attributes": {"POSITION": self.array(positions)}}
        for name, values in attributes.items():
            primitive["attributes"][name] = self.array(np.asarray(values, np.float32))
        if indexed:
            primitive["indices"] = self.array(np.array([0, 1, 2, 0, 2, 3], np.uint16))
        if material is not None:
            primitive["material"] = material
        self.document.setdefault("meshes", []).append({"primitives": [primitive]})
        return self

    def image(self, pixels):
        """An embedded PNG as texture 0."""
        stream = io.BytesIO()
        Image.fromarray(np.asarray(pixels, np.uint8)).save(stream, "PNG")
        self.document["images"] = [{"bufferView": self.view(stream.getvalue()), "mimeType": "image/png"}]
        self.document["textures"] = [{"source": 0}]
        return self

    def gltf(self, path):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        document = {**self.document, "buffers": [{"byteLength": len(self.binary), "uri": uri}]}
        path.write_text(json.dumps(document))
        return path

    def glb(self, path):
        binary = self.binary + b"\0" * (-len(self.binary) % 4)
        text = json.dumps({**self.document, "buffers": [{"byteLength": len(binary)}]}).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
        return path


def first(builder, tmp_path, **options):
    return load(builder.glb(tmp_path / "a.glb"), **(options or AUTO)).shapes[0]


def area_vector(shape):
    corners = np.asarray(shape.mesh.vertices)[shape.mesh.faces]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0) / 2
