#include "apps/demo/gl_window.h"

#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "apps/common/open_scene.h"
#include "engine/scene/image.h"

namespace zoe {
namespace {

constexpr float kFontSize = 13.0f;  // of Dear ImGui's own font, or a multiple: its letters are drawn in pixels

bool is_set(const char* variable) {
    const char* const value = std::getenv(variable);
    return value && *value;
}

std::string glfw_reason() {
    const char* text = nullptr;
    glfwGetError(&text);
    return one_line(text ? text : "no reason given");
}

void save_screenshot(int width, int height, const std::filesystem::path& file) {
    const size_t row_size = size_t{4} * width;
    std::vector<uint8_t> bottom_up(row_size * height), top_down(row_size * height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, bottom_up.data());
    for (int y = 0; y < height; ++y) {
        for (size_t i = 0; i < row_size; ++i) {
            top_down[y * row_size + i] = i % 4 == 3 ? 255 : bottom_up[(height - 1 - y) * row_size + i];
        }
    }
    write_png(file, width, height, top_down);
}

/// Makes letters and gaps as large as the screen asks for. Some systems do a part of that: there, units of the interface
/// are several pixels.
void scale_interface(GLFWwindow* window) {
    float pixels = 1.0f, ignored = 1.0f;
    glfwGetWindowContentScale(window, &pixels, &ignored);
    int width = 0, height = 0, pixel_width = 0, pixel_height = 0;
    glfwGetWindowSize(window, &width, &height);
    glfwGetFramebufferSize(window, &pixel_width, &pixel_height);
    const float pixels_a_unit = width > 0 ? float(pixel_width) / float(width) : 1.0f;

    ImGuiIO& io = ImGui::GetIO();
    ImFontConfig font;
    font.SizePixels = std::round(kFontSize * pixels);
    font.OversampleH = font.OversampleV = 1;
    font.PixelSnapH = true;
    io.Fonts->AddFontDefault(&font);
    io.FontGlobalScale = 1.0f / pixels_a_unit;
    ImGui::GetStyle().ScaleAllSizes(pixels / pixels_a_unit);
}

}  // namespace

GlWindow::GlWindow(std::optional<PictureSize> size) {
    if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) throw NoWindow("no display");
    if (!glfwInit()) throw NoWindow(glfw_reason());
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 0);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, size ? GLFW_FALSE : GLFW_TRUE);
    const auto [width, height] = size.value_or(kDefaultWindowSize);
    window_ = glfwCreateWindow(width, height, "Zoetrope", nullptr, nullptr);
    if (!window_) {
        const std::string reason = glfw_reason();
        glfwTerminate();
        throw NoWindow(reason);
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetTime(0.0);
    glfwSetWindowUserPointer(window_, this);
    // Dear ImGui puts its own in front, and calls this one.
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
        if (action == GLFW_RELEASE) return;
        static_cast<GlWindow*>(glfwGetWindowUserPointer(window))->keys_.push_back({key, action == GLFW_REPEAT});
    });
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
        if (count > 0) static_cast<GlWindow*>(glfwGetWindowUserPointer(window))->dropped_ = paths[0];
    });

    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // the window leaves no files behind
    ImGui::StyleColorsDark();
    scale_interface(window_);
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 130");

    glGenTextures(1, &texture_);
    glBindTexture(GL_TEXTURE_2D, texture_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

GlWindow::~GlWindow() {
    glDeleteTextures(1, &texture_);
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
}

bool GlWindow::is_closing() const {
    return glfwWindowShouldClose(window_);
}

void GlWindow::close() {
    glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

void GlWindow::hide() {
    glfwHideWindow(window_);
}

double GlWindow::seconds() const {
    return glfwGetTime();
}

void GlWindow::set_title(const std::string& title) {
    glfwSetWindowTitle(window_, title.c_str());
}

std::vector<KeyPress> GlWindow::take_keys() {
    return std::exchange(keys_, {});
}

std::string GlWindow::take_dropped() {
    return std::exchange(dropped_, {});
}

void GlWindow::wake() {
    glfwPostEmptyEvent();
}

void GlWindow::begin_frame(double wait_s) {
    glfwWaitEventsTimeout(wait_s);
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
}

void GlWindow::end_frame(const std::filesystem::path& screenshot) {
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    glViewport(0, 0, width, height);
    glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (!screenshot.empty() && width > 0 && height > 0) save_screenshot(width, height, screenshot);
    glfwSwapBuffers(window_);
}

void GlWindow::set_texture(int width, int height, const uint8_t* rgba) {
    glBindTexture(GL_TEXTURE_2D, texture_);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}

}  // namespace zoe
