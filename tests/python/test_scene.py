# SPDX-License-Identifier: Apache-2.0
"""Scenes: their data as arrays, their files, and faults of both."""

import gc
import pathlib
import shutil
import tempfile
import unittest

import numpy as np
import support

import ibr


class SceneData(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = ibr.load_scene(support.SCENE)

    def test_photographs_and_cells_are_sequences(self):
        nodes = self.scene.nodes
        self.assertEqual(len(nodes), 8)
        self.assertEqual([node.name for node in nodes][:2], ["photo0000.jpg", "photo0001.jpg"])
        self.assertEqual(nodes[-1].name, nodes[7].name)
        self.assertEqual([node.name for node in nodes[2:6:2]], [nodes[2].name, nodes[4].name])
        for index in (8, -9):
            with self.assertRaises(IndexError):
                nodes[index]
        self.assertGreater(len(self.scene.cells), 0)
        self.assertEqual(len(self.scene.backdrops), 8)

    def test_a_node_names_its_camera_and_files(self):
        node = self.scene.nodes[0]
        self.assertEqual((node.camera.intrinsics.width, node.camera.intrinsics.height), (192, 144))
        self.assertTrue((self.scene.folder / node.image_file).is_file())
        self.assertIsNone(node.mask_file)
        self.assertEqual(self.scene.folder, support.SCENE)
        with self.assertRaises(AttributeError):
            node.name = "other"

    def test_mesh_arrays_have_the_documented_shapes_and_types(self):
        cell = self.scene.cells[0]
        mesh, members = cell.mesh, len(cell.members)
        count, triangles = len(mesh.inverse_distance), len(mesh.triangles)
        self.assertEqual([match.shape for match in mesh.match], members * [(count, 2)])
        self.assertEqual([ratio.shape for ratio in mesh.ratio], members * [(count,)])
        self.assertEqual(mesh.match[0].dtype, np.float32)
        self.assertEqual((mesh.triangles.shape, mesh.triangles.dtype), ((triangles, 3), np.uint32))
        self.assertEqual((mesh.tier.shape, mesh.tier.dtype), ((triangles,), np.uint8))
        self.assertEqual(mesh.ecc.shape, (triangles,))
        self.assertLess(mesh.triangles.max(), count)
        self.assertEqual(np.count_nonzero(mesh.tier == 0), mesh.tier0_count)
        self.assertTrue((mesh.inverse_distance >= 0).all())

    def test_mesh_arrays_are_views_that_cannot_be_written(self):
        mesh = self.scene.cells[0].mesh
        self.assertTrue(np.shares_memory(mesh.triangles, mesh.triangles))
        with self.assertRaises(ValueError):
            mesh.inverse_distance[0] = 1

    def test_mesh_arrays_outlive_their_scene(self):
        scene = ibr.load_scene(support.SCENE)
        expected = scene.cells[0].mesh.inverse_distance.copy()
        array, node = scene.cells[0].mesh.inverse_distance, scene.nodes[0]
        del scene
        gc.collect()
        np.testing.assert_array_equal(array, expected)
        self.assertEqual(node.name, "photo0000.jpg")

    def test_vertices_project_to_their_matches(self):
        cell = self.scene.cells[0]
        positions = self.scene.vertex_positions(0)
        self.assertEqual((positions.shape, positions.dtype), ((len(cell.mesh.inverse_distance), 3), np.float64))
        near = np.isfinite(positions).all(axis=1)
        self.assertGreater(np.count_nonzero(near), 100)
        for member, match in zip(cell.members, cell.mesh.match):
            camera = self.scene.nodes[member].camera
            axes = camera.pose.matrix[:3, :3]
            seen = camera.intrinsics.project((positions[near] - camera.pose.position) @ axes)
            self.assertLess(np.median(np.linalg.norm(seen - match[near], axis=1)), 1)
        with self.assertRaises(IndexError):
            self.scene.vertex_positions(len(self.scene.cells))

    def test_a_built_scene_has_no_faults(self):
        self.assertEqual(ibr.validate(self.scene), ())
        self.assertEqual(ibr.validate_scene_files(support.SCENE), ())

    def test_memory_and_advice(self):
        demand = ibr.memory_demand(self.scene)
        self.assertGreater(demand.textures, 8 * 4 * 192 * 144)
        self.assertEqual(demand.sum, demand.positions + demand.indices + demand.textures + demand.depth)
        advice = ibr.advise_capture(self.scene, views=2, read_textures=False)
        self.assertLessEqual(len(advice.views), 2)
        self.assertTrue(0 <= advice.coverage <= 1)
        for entry in advice.advice:
            self.assertIsInstance(entry.kind, ibr.AdviceKind)
            self.assertIsInstance(entry.severity, ibr.Severity)


class SceneFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_a_scene_loads_from_text_and_path_of_folder_and_file(self):
        for path in (support.SCENE, str(support.SCENE), support.SCENE / "scene.gltf"):
            self.assertEqual(len(ibr.load_scene(path).nodes), 8)

    def test_a_missing_scene_is_an_io_error_with_the_file(self):
        with self.assertRaises(ibr.Error) as caught:
            ibr.load_scene(self.folder / "nöwhere")
        self.assertEqual(caught.exception.code, ibr.ErrorCode.IO)
        self.assertIn("nöwhere", str(caught.exception))
        self.assertIsInstance(caught.exception, RuntimeError)

    def test_a_damaged_scene_is_an_invalid_input(self):
        (self.folder / "scene.gltf").write_text("{", encoding="utf-8")
        self.assertEqual(support.code_of(lambda: ibr.load_scene(self.folder)), ibr.ErrorCode.INVALID_INPUT)
        faults = ibr.validate_scene_files(self.folder)
        self.assertEqual(len(faults), 1)
        self.assertTrue(faults[0].message)

    def test_a_missing_texture_is_a_fault_with_its_place(self):
        copy = self.folder / "copy"
        shutil.copytree(support.SCENE, copy)
        (copy / ibr.load_scene(copy).nodes[3].texture_file).unlink()
        faults = ibr.validate_scene_files(copy)
        self.assertEqual(len(faults), 1)
        self.assertTrue(faults[0].field.startswith("/"))

    def test_a_name_that_is_not_utf8_comes_back_in_the_message(self):
        name = self.folder / b"caf\xe9".decode("utf-8", "surrogateescape")
        with self.assertRaises(ibr.Error) as caught:
            ibr.load_scene(name)
        self.assertIn(name.name, str(caught.exception))

    def test_paths_of_another_type_are_type_errors(self):
        for path in (None, 3, ["scene"]):
            with self.assertRaises(TypeError):
                ibr.load_scene(path)

    def test_a_copy_of_a_scene_is_equal(self):
        ibr.copy_scene(ibr.load_scene(support.SCENE), self.folder / "copy")
        copy = ibr.load_scene(self.folder / "copy")
        self.assertEqual(ibr.validate_scene_files(self.folder / "copy"), ())
        original = ibr.load_scene(support.SCENE).cells[0].mesh
        np.testing.assert_array_equal(copy.cells[0].mesh.match[0], original.match[0])

    def test_kinds_of_assets(self):
        self.assertEqual(ibr.asset_kind(support.SCENE), ibr.AssetKind.SCENE)
        self.assertEqual(ibr.asset_kind(support.MODEL), ibr.AssetKind.HTM_MODEL)
        self.assertIsNone(ibr.asset_kind(self.folder))


if __name__ == "__main__":
    support.main()
