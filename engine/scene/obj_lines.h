#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <string>
#include <vector>

namespace zoe {

/// Reads the lines of an .obj file, whatever ends them: LF, CR LF or CR. One that ends with a backslash goes on in the next
/// one, a space in its place, unless it is a comment: those hold paths. A byte order mark at the front is passed over.
class ObjLines {
public:
    /// stream     binary, at its beginning; must outlive this.
    /// max_bytes  of a line with all that it goes on in.
    ObjLines(std::istream& stream, size_t max_bytes);

    /// Reads a line, without its end.
    /// Returns    false where there is none left.
    /// Throws     std::length_error where it is longer than allowed.
    bool next(std::string* line);

    /// Where the last line began, from 1.
    uint64_t number() const { return number_; }

private:
    bool fill();
    bool append_part(std::string* line);

    std::istream& stream_;
    const size_t max_bytes_;
    std::vector<char> buffer_;
    size_t at_ = 0, end_ = 0;  ///< What of the buffer is still to be read.
    uint64_t number_ = 0, next_number_ = 1;
};

}  // namespace zoe
