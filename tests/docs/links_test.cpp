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

/// "bvh/Refit", "bvh/Refit.Name": the suites and tests that there are, by the folder that their program is named for.
std::set<std::string> tests_by_folder() {
    std::set<std::string> tests;
    const std::regex definition("TEST(?:_F|_P)?\\((\\w+), (\\w+)\\)");
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kRoot / "tests")) {
        if (entry.path().extension() != ".cpp") continue;
        const std::string folder = entry.path().parent_path().filename().string(), text = text_of(entry.path());
        for (auto it = std::sregex_iterator(text.begin(), text.end(), definition); it != std::sregex_iterator(); ++it) {
            const std::string suite = folder + '/' + (*it)[1].str();
            tests.insert(suite);
            tests.insert(suite + '.' + (*it)[2].str());
        }
    }
    return tests;
}

/// Rows of the table under a heading, each of which must name tests or charts that exist. Returns how many it names.
int expect_tests_of_table(const fs::path& document, const std::string& heading) {
    const std::set<std::string> tests = tests_by_folder();
    const std::string charts = text_of(kRoot / "apps/chart/charts.cpp");
    const std::regex test("`(\\w+/)?([A-Z]\\w+(?:\\.\\w+)?)`"), chart("chart `([a-z-]+)`");
    std::istringstream text(text_of(kRoot / document));
    std::string line;
    while (std::getline(text, line) && !line.starts_with(heading)) {
    }
    int count = 0;
    while (std::getline(text, line) && line.starts_with("|")) {
        if (line.starts_with("|---")) continue;
        const int before = count;
        for (auto it = std::sregex_iterator(line.begin(), line.end(), test); it != std::sregex_iterator(); ++it) {
            const std::string folder = (*it)[1].matched ? (*it)[1].str() : "stability/";
            EXPECT_TRUE(tests.contains(folder + (*it)[2].str())) << it->str();
            ++count;
        }
        for (auto it = std::sregex_iterator(line.begin(), line.end(), chart); it != std::sregex_iterator(); ++it) {
            EXPECT_NE(charts.find("ChartInfo{\"" + (*it)[1].str() + '"'), std::string::npos) << it->str();
            ++count;
        }
        EXPECT_GT(count, before) << "neither test nor chart: " << line;
    }
    return count;
}

TEST(Links, OfTheStabilityTableAreTestsThatExist) {
    EXPECT_GT(expect_tests_of_table("tests/stability/README.md", "| method"), 100);
}

TEST(Links, OfWhatTheReadmeSaysOfAccuracyAreTestsAndChartsThatExist) {
    EXPECT_GT(expect_tests_of_table("README.md", "| what this page says of accuracy"), 12);
}

}  // namespace
}  // namespace zoe::test
