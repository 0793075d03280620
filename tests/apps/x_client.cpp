#include "tests/apps/virtual_screen.h"

#include <chrono>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include <X11/Xatom.h>
#include <X11/Xlib.h>

namespace zoe::test {
namespace {

using Connection = std::unique_ptr<Display, int (*)(Display*)>;

Connection connect(const std::string& display) {
    Connection connection(XOpenDisplay(display.c_str()), &XCloseDisplay);
    if (!connection) throw std::runtime_error("cannot connect to display " + display);
    return connection;
}

/// The window, without a window manager a child of the screen's.
Window find_window(Display* display, const std::string& title) {
    Window root = 0, parent = 0, *children = nullptr, found = 0;
    unsigned count = 0;
    XQueryTree(display, XDefaultRootWindow(display), &root, &parent, &children, &count);
    for (unsigned k = 0; k < count; ++k) {
        char* name = nullptr;
        if (!XFetchName(display, children[k], &name) || !name) continue;
        if (std::string(name).starts_with(title)) found = children[k];
        XFree(name);
    }
    if (children) XFree(children);
    return found;
}

}  // namespace

std::string drop_file(const std::string& display_name, const std::string& title, const std::string& file) {
    const Connection connection = connect(display_name);
    Display* const display = connection.get();
    const auto atom = [&](const char* name) { return XInternAtom(display, name, False); };
    const Window target = find_window(display, title);
    if (!target) return "no such window";
    const Window source = XCreateSimpleWindow(display, XDefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0);
    const Atom selection = atom("XdndSelection"), uris = atom("text/uri-list");
    XSetSelectionOwner(display, selection, source, CurrentTime);
    const auto tell = [&](const char* message, long a, long b, long c, long d) {
        XEvent event = {};
        event.xclient.type = ClientMessage;
        event.xclient.window = target;
        event.xclient.message_type = atom(message);
        event.xclient.format = 32;
        const long data[5] = {static_cast<long>(source), a, b, c, d};
        std::memcpy(event.xclient.data.l, data, sizeof data);
        XSendEvent(display, target, False, NoEventMask, &event);
        XFlush(display);
    };
    // The source tells where it is; the target answers, asks for the text once it is dropped, and says that it is done.
    tell("XdndEnter", 5L << 24, static_cast<long>(uris), 0, 0);
    tell("XdndPosition", 0, 20L << 16 | 20L, CurrentTime, static_cast<long>(atom("XdndActionCopy")));
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begin < std::chrono::seconds(60)) {
        if (XPending(display) == 0) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            continue;
        }
        XEvent event;
        XNextEvent(display, &event);
        if (event.type == ClientMessage && event.xclient.message_type == atom("XdndStatus")) {
            if (!(event.xclient.data.l[1] & 1)) return "the window does not take it";
            tell("XdndDrop", 0, CurrentTime, 0, 0);
        } else if (event.type == SelectionRequest) {
            const XSelectionRequestEvent& request = event.xselectionrequest;
            const std::string text = "file://" + file + "\r\n";
            XChangeProperty(display, request.requestor, request.property, request.target, 8, PropModeReplace,
                            reinterpret_cast<const unsigned char*>(text.data()), static_cast<int>(text.size()));
            XEvent answer = {};
            answer.xselection.type = SelectionNotify;
            answer.xselection.requestor = request.requestor;
            answer.xselection.selection = request.selection;
            answer.xselection.target = request.target;
            answer.xselection.property = request.property;
            answer.xselection.time = request.time;
            XSendEvent(display, request.requestor, False, NoEventMask, &answer);
            XFlush(display);
        } else if (event.type == ClientMessage && event.xclient.message_type == atom("XdndFinished")) {
            return "";
        }
    }
    return "the window does not answer";
}

void set_dots_per_inch(const std::string& display_name, int dots) {
    const Connection connection = connect(display_name);
    const std::string text = "Xft.dpi:\t" + std::to_string(dots) + "\n";
    XChangeProperty(connection.get(), XDefaultRootWindow(connection.get()), XA_RESOURCE_MANAGER, XA_STRING, 8,
                    PropModeReplace, reinterpret_cast<const unsigned char*>(text.data()), static_cast<int>(text.size()));
    XSync(connection.get(), False);
}

}  // namespace zoe::test
