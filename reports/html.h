// The few pieces of HTML that pages are made of. Every text from outside goes through Escape() or ScriptData().
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/pictures.h"

namespace dynoproof::reports {

/// The text with & < > " ' written as entities: fit for elements and quoted attributes.
std::string Escape(std::string_view text);

/// A document inside <script type="application/json">: no text of it can end the element.
std::string ScriptData(const nlohmann::json& document);

/// An id for links: letters, digits, "-" and "_" stay, other bytes become "." and two hexadecimal digits, so that no
/// two texts share one.
std::string Anchor(std::string_view text);

/// A cell of a table: HTML, and a class or none.
struct Cell {
  std::string html, css = {};
};
/// A row of cells.
std::string Row(std::span<const Cell> cells);
/// `header`: plain texts, with the class of their column.
std::string Table(std::span<const Cell> header, const std::string& rows);

/// Pictures as places for the page's script, and the data that fill them. `id` is unique in the page; curves are
/// thinned so that all of them have at most about `most_samples` together.
std::string Figures(const std::string& id, const std::vector<Picture>& pictures, std::size_t most_samples);

/// The program, its commit and compiler, as every page names them.
std::string BuildLine();

/// The whole page around `body`. `title` and `provenance` are plain texts; the title says what was asked of what, and the
/// verdict. `lead` is HTML: the sentence below the title, which says the same with its reason.
std::string Page(const std::string& title, const std::string& lead, const std::string& provenance,
                 const std::string& body);

/// Whether uPlot draws the pictures; else they are drawn plainly.
bool HasPlotLibrary();

}  // namespace dynoproof::reports
