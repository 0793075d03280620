#include "apps/common/mp4.h"

#include <cerrno>

#include <fmt/format.h>

#include "apps/common/interrupt.h"
#include "apps/common/picture.h"
#include "apps/common/program_pipe.h"
#include "apps/common/write_file.h"

namespace zoe {
namespace {

std::string feed(ProgramPipe& ffmpeg, std::span<const std::filesystem::path> pictures, const Grade& grade,
                 const Picture& first) {
    for (const std::filesystem::path& path : pictures) {
        if (is_interrupted()) throw Interrupted("interrupted");
        const Picture picture = load_picture(path, grade);
        if (picture.width != first.width || picture.height != first.height) {
            return fmt::format("{} is of another size than {}", path.native(), pictures.front().native());
        }
        if (!ffmpeg.write(picture.rgba)) break;  // its exit code says why
    }
    const std::string outcome = ffmpeg.close();
    if (is_interrupted()) throw Interrupted("interrupted");  // the terminal interrupts ffmpeg too
    return outcome.empty() ? "" : "ffmpeg " + outcome;
}

}  // namespace

std::string write_mp4(std::span<const std::filesystem::path> pictures, double fps, const Grade& grade,
                      const std::filesystem::path& file) {
    const Picture first = load_picture(pictures.front(), grade);
    // "file:" keeps ffmpeg from reading a protocol into the name; H.264 needs even sides.
    const std::filesystem::path temporary = temporary_name(file);
    const std::vector<std::string> arguments = {"ffmpeg",
                                                "-nostdin",
                                                "-loglevel",
                                                "error",
                                                "-y",
                                                "-f",
                                                "rawvideo",
                                                "-pix_fmt",
                                                "rgba",
                                                "-s",
                                                fmt::format("{}x{}", first.width, first.height),
                                                "-framerate",
                                                fmt::format("{}", fps),
                                                "-i",
                                                "pipe:0",
                                                "-vf",
                                                "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                                "-pix_fmt",
                                                "yuv420p",
                                                "-movflags",
                                                "+faststart",
                                                "-f",
                                                "mp4",
                                                "file:" + temporary.native()};
    std::string reason;
    std::error_code error;
    try {
        ProgramPipe ffmpeg(arguments);
        if (!ffmpeg.is_running())
            return ffmpeg.start_error() == ENOENT ? "ffmpeg is not installed" : "ffmpeg: " + ffmpeg.close();
        reason = feed(ffmpeg, pictures, grade, first);
    } catch (...) {
        std::filesystem::remove(temporary, error);
        throw;
    }
    if (reason.empty()) {
        std::filesystem::rename(temporary, file, error);
        if (error) reason = fmt::format("{}: {}", file.native(), error.message());
    }
    if (!reason.empty()) std::filesystem::remove(temporary, error);
    return reason;
}

}  // namespace zoe
