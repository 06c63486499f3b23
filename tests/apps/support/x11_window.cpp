// SPDX-License-Identifier: Apache-2.0
#include "x11_window.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <array>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

namespace ibr::test {
namespace {

struct Closer {
  void operator()(Display* display) const { XCloseDisplay(display); }
  void operator()(XImage* image) const { XDestroyImage(image); }
};

// Opens the display. Errors are ignored, because windows may disappear or be resized; Xlib would end the program.
std::unique_ptr<Display, Closer> openDisplay() {
  XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });
  std::unique_ptr<Display, Closer> display(XOpenDisplay(nullptr));
  if (!display) throw std::runtime_error("no display");
  return display;
}

// Source of a drag: an invisible window that owns the selection and answers the target's requests.
class DragSource {
 public:
  DragSource(Display* display, Window target, const std::vector<std::filesystem::path>& paths)
      : display_(display),
        target_(target),
        self_(XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0)) {
    for (const auto& path : paths) {
      text_ += "file://";
      for (const char c : path.string()) text_ += c == ' ' ? "%20" : std::string(1, c);
      text_ += "\r\n";
    }
    XSetSelectionOwner(display_, atom("XdndSelection"), self_, CurrentTime);
  }

  void drop() {
    constexpr long kVersion = 5;
    XWindowAttributes is{};
    XGetWindowAttributes(display_, target_, &is);
    int x = 0, y = 0;
    Window ignored = 0;
    XTranslateCoordinates(display_, target_, is.root, is.width / 2, is.height / 2, &x, &y, &ignored);
    send("XdndEnter", {long(self_), kVersion << 24, long(atom("text/uri-list")), 0, 0});
    send("XdndPosition", {long(self_), 0, long(x) << 16 | y, CurrentTime, long(atom("XdndActionCopy"))});
    if (!(waitFor("XdndStatus").data.l[1] & 1)) throw std::runtime_error("the window refuses the dropped files");
    send("XdndDrop", {long(self_), 0, CurrentTime, 0, 0});
    waitFor("XdndFinished");
  }

 private:
  Atom atom(const char* name) { return XInternAtom(display_, name, False); }

  void send(const char* message, const std::array<long, 5>& data) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = target_;
    event.xclient.message_type = atom(message);
    event.xclient.format = 32;
    for (std::size_t i = 0; i < data.size(); ++i) event.xclient.data.l[i] = data[i];
    XSendEvent(display_, target_, False, NoEventMask, &event);
    XFlush(display_);
  }

  void answer(const XSelectionRequestEvent& request) {
    XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(text_.data()), int(text_.size()));
    XEvent event{};
    event.xselection.type = SelectionNotify;
    event.xselection.requestor = request.requestor;
    event.xselection.selection = request.selection;
    event.xselection.target = request.target;
    event.xselection.property = request.property;
    event.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &event);
    XFlush(display_);
  }

  XClientMessageEvent waitFor(const char* message) {
    using Clock = std::chrono::steady_clock;
    for (const auto until = Clock::now() + std::chrono::seconds(10); Clock::now() < until;) {
      if (XPending(display_) == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        continue;
      }
      XEvent event;
      XNextEvent(display_, &event);
      if (event.type == SelectionRequest) answer(event.xselectionrequest);
      if (event.type == ClientMessage && event.xclient.message_type == atom(message)) return event.xclient;
    }
    throw std::runtime_error(std::string("no ") + message + " from the window");
  }

  Display* display_;
  Window target_, self_;
  std::string text_;
};

// Sets the resolution in the X resources, where desktops store it.
void setDpi(int dotsPerInch) {
  const auto display = openDisplay();
  const std::string text = "Xft.dpi:\t" + std::to_string(dotsPerInch) + "\n";
  XChangeProperty(display.get(), DefaultRootWindow(display.get()), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                  reinterpret_cast<const unsigned char*>(text.data()), int(text.size()));
}

// Waits for one answer of the window: programs forward the message to the root window, where window managers receive
// the message (Extended Window Manager Hints, "_NET_WM_PING").
void ping(Display* display, Window window, long stamp) {
  using Clock = std::chrono::steady_clock;
  const Atom protocols = XInternAtom(display, "WM_PROTOCOLS", False),
             question = XInternAtom(display, "_NET_WM_PING", False);
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = window;
  event.xclient.message_type = protocols;
  event.xclient.format = 32;
  event.xclient.data.l[0] = long(question);
  event.xclient.data.l[1] = stamp;
  event.xclient.data.l[2] = long(window);
  XSendEvent(display, window, False, NoEventMask, &event);
  XFlush(display);
  for (const auto until = Clock::now() + std::chrono::minutes(2); Clock::now() < until;) {
    if (XPending(display) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      continue;
    }
    XNextEvent(display, &event);
    const auto& answer = event.xclient;
    if (event.type == ClientMessage && answer.message_type == protocols && answer.data.l[0] == long(question) &&
        answer.data.l[1] == stamp && answer.data.l[2] == long(window))
      return;
  }
  throw std::runtime_error("the window does not answer");
}

}  // namespace

void waitForFrames(const std::string& window, int times) {
  const auto display = openDisplay();
  XSelectInput(display.get(), DefaultRootWindow(display.get()), SubstructureNotifyMask);
  for (int i = 1; i <= times; ++i) ping(display.get(), std::stoul(window), i);
}

MonitorDpi::MonitorDpi(int dotsPerInch) {
  setDpi(dotsPerInch);
}
MonitorDpi::~MonitorDpi() {
  setDpi(96);
}

Image8 pixelsOf(const std::string& window) {
  const auto display = openDisplay();
  const Window id = std::stoul(window);
  XWindowAttributes is{};
  if (!XGetWindowAttributes(display.get(), id, &is)) return {};
  const std::unique_ptr<XImage, Closer> seen(
      XGetImage(display.get(), id, 0, 0, unsigned(is.width), unsigned(is.height), AllPlanes, ZPixmap));
  if (!seen) return {};
  Image8 image(is.width, is.height, 3);
  for (int y = 0; y < is.height; ++y)
    for (int x = 0; x < is.width; ++x) {
      const unsigned long value = XGetPixel(seen.get(), x, y);
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[std::size_t(c)] = std::uint8_t(value >> (16 - 8 * c));
    }
  return image;
}

void dropOnto(const std::string& window, const std::vector<std::filesystem::path>& paths) {
  const auto display = openDisplay();
  DragSource(display.get(), std::stoul(window), paths).drop();
}

}  // namespace ibr::test
