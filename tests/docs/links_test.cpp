#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace zoe::test {
namespace {

namespace fs = std::filesystem;
const fs::path kRoot = ZOETROPE_SOURCE_DIR;

std::vector<fs::path> documents() {
    std::vector<fs::path> found;
    for (auto it = fs::recursive_directory_iterator(kRoot); it != fs::recursive_directory_iterator(); ++it) {
        const std::string name = it->path().filename().string();
        if (it->is_directory() && (name == "build" || name == "out" || name == ".git")) it.disable_recursion_pending();
        if (it->path().extension() == ".md") found.push_back(it->path());
    }
    return found;
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Targets of Markdown links and of src and href attributes, without what stands inside code.
std::vector<std::string> links_in(const std::string& markdown) {
    const std::string text = std::regex_replace(markdown, std::regex("```[^`]*```|`[^`\n]*`"), "``");
    std::vector<std::string> links;
    const std::regex link("\\]\\(([^)\\s]+)[^)]*\\)|(?:src|href)=\"([^\"]+)\"");
    for (auto it = std::sregex_iterator(text.begin(), text.end(), link); it != std::sregex_iterator(); ++it) {
        links.push_back((*it)[1].matched ? (*it)[1].str() : (*it)[2].str());
    }
    return links;
}

TEST(Links, AreFound) {
    const std::vector<std::string> expected = {"a/b.cpp", "pic.png", "c.md#part", "https://example.org/x"};
    EXPECT_EQ(links_in("see [x](a/b.cpp) and <img src=\"pic.png\"> [y](c.md#part) `[no](code)` [z](https://example.org/x)"),
              expected);
}

TEST(Links, OfEveryDocumentLeadSomewhere) {
    int count = 0;
    for (const fs::path& document : documents()) {
        for (std::string link : links_in(text_of(document))) {
            if (link.starts_with("http://") || link.starts_with("https://") || link.starts_with("#")) continue;
            link = link.substr(0, link.find('#'));
            EXPECT_TRUE(fs::exists(document.parent_path() / link)) << fs::relative(document, kRoot) << ": " << link;
            EXPECT_FALSE(fs::path(link).is_absolute()) << fs::relative(document, kRoot) << ": " << link;
            ++count;
        }
    }
    EXPECT_GT(count, 20);
}

TEST(Links, ReadmeLinksEveryStageAndEveryOtherDocument) {
    const std::string readme = text_of(kRoot / "README.md");
    for (const char* stage : {"animate", "deform", "update_blas", "build_tlas", "trace"}) {
        const std::string link = "[" + std::string(stage) + "](engine/frame/" + stage + ".cpp)";
        EXPECT_NE(readme.find(link), std::string::npos) << link;
    }
    for (const char* document : {"CONTRIBUTING.md", "LICENSE", "content/CONTENT.md", "tests/stability/README.md"}) {
        EXPECT_NE(readme.find(document), std::string::npos) << document;
    }
}

TEST(Links, OfTheStabilityTableAreTestsThatExist) {
    std::set<std::string> tests;
    const std::regex definition("TEST(?:_F|_P)?\\((\\w+), (\\w+)\\)");
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kRoot / "tests")) {
        if (entry.path().extension() != ".cpp") continue;
        const std::string text = text_of(entry.path());
        for (auto it = std::sregex_iterator(text.begin(), text.end(), definition); it != std::sregex_iterator(); ++it) {
            tests.insert((*it)[1].str());
            tests.insert((*it)[1].str() + "." + (*it)[2].str());
        }
    }
    int count = 0;
    const std::regex name("`(?:\\w+/)?([A-Z]\\w+(?:\\.\\w+)?)`");
    std::istringstream table(text_of(kRoot / "tests/stability/README.md"));
    for (std::string line; std::getline(table, line);) {
        if (!line.starts_with("|")) continue;
        for (auto it = std::sregex_iterator(line.begin(), line.end(), name); it != std::sregex_iterator(); ++it) {
            EXPECT_TRUE(tests.contains((*it)[1].str())) << (*it)[1].str();
            ++count;
        }
    }
    EXPECT_GT(count, 40);
}

}  // namespace
}  // namespace zoe::test
