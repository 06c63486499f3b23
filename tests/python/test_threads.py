# SPDX-License-Identifier: Apache-2.0
"""Renderers on several threads. A case that hangs has a lock that is held while another is waited for."""

import concurrent.futures
import threading

import numpy as np
import support

import ibr
import ibr.author

SIZE = (160, 120)


class Threads(support.DeviceTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = ibr.load_scene(support.SCENE)
        images = ibr.author.read_transforms(support.DATA / "views.json").images
        cls.views = [image.camera for image in images]
        renderer = ibr.Renderer(cls.scene, SIZE, device=cls.device)
        cls.expected = [renderer.render(view) for view in cls.views]

    def check(self, renderers):
        def render(work):
            return renderers[work % len(renderers)].render(self.views[work % len(self.views)])

        with concurrent.futures.ThreadPoolExecutor(2) as threads:
            for work, picture in enumerate(threads.map(render, range(12))):
                np.testing.assert_array_equal(picture, self.expected[work % len(self.views)])

    def test_two_threads_render_each_with_its_own_device(self):
        self.check([ibr.Renderer(self.scene, SIZE) for _ in range(2)])

    def test_two_threads_render_with_renderers_of_one_device(self):
        self.check([ibr.Renderer(self.scene, SIZE, device=self.device) for _ in range(2)])

    def test_two_threads_render_with_one_renderer(self):
        self.check([ibr.Renderer(self.scene, SIZE, device=self.device)])

    def test_renderers_are_made_and_dropped_while_others_render(self):
        renderer = ibr.Renderer(self.scene, SIZE, device=self.device)
        with concurrent.futures.ThreadPoolExecutor(2) as threads:
            made = threads.submit(lambda: [ibr.Renderer(self.scene, SIZE, device=self.device) for _ in range(3)])
            pictures = threads.map(lambda _: renderer.render(self.views[0]), range(6))
            for picture in pictures:
                np.testing.assert_array_equal(picture, self.expected[0])
            self.assertEqual(len(made.result()), 3)
            del made

    def test_a_thread_waits_for_the_device_without_the_interpreter_s_lock(self):
        renderer = ibr.Renderer(self.scene, SIZE, device=self.device)
        model = ibr.load_htm_model(support.MODEL)
        has_device, may_go_on = threading.Event(), threading.Event()

        def pictures(of, camera):  # called while its thread has the device
            has_device.set()
            may_go_on.wait()
            return ibr.author.read_htm_picture(of, camera)

        with concurrent.futures.ThreadPoolExecutor(2) as threads:
            made = threads.submit(ibr.HtmRenderer, model, pictures, device=self.device)
            has_device.wait()
            picture = threads.submit(renderer.render, self.views[0])
            while not picture.running():  # it soon waits for the device
                pass
            self.assertFalse(made.done())
            may_go_on.set()
            np.testing.assert_array_equal(picture.result(), self.expected[0])
            made.result()

    def test_a_callback_may_use_the_device_that_its_call_has(self):
        renderer = ibr.Renderer(self.scene, SIZE, device=self.device)
        rendered = []

        def pictures(of, camera):
            rendered.append(renderer.render(self.views[0]))
            return ibr.author.read_htm_picture(of, camera)

        ibr.HtmRenderer(ibr.load_htm_model(support.MODEL), pictures, device=self.device)
        self.assertEqual(len(rendered), 8)
        np.testing.assert_array_equal(rendered[0], self.expected[0])


if __name__ == "__main__":
    support.main()
