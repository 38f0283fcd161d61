//! Drawings of the pages as SVG markup.

use std::fmt::{Display, Write as _};

use askama::filters::Safe;

use super::markup::Escaping;

/// SVG markup, built element by element. Names are literals of the program. Values and texts are escaped.
#[derive(Debug, Default)]
pub struct Svg(String);

impl Svg {
    /// Markup of a drawing: one element `svg` with this content.
    pub fn drawing(
        attributes: impl FnOnce(Element<'_>) -> Element<'_>,
        content: impl FnOnce(&mut Self),
    ) -> Self {
        let mut svg = Self::default();
        attributes(svg.element("svg")).around(content);
        svg
    }

    /// Begins an element.
    pub fn element(&mut self, name: &'static str) -> Element<'_> {
        self.0.push('<');
        self.0.push_str(name);
        Element { svg: self, name }
    }

    /// Begins an element `line` at height `y` from `x1` to `x2`.
    pub fn across(&mut self, y: f64, x1: impl Display, x2: impl Display) -> Element<'_> {
        let from = self.element("line").with("x1", x1).at("y1", y);
        from.with("x2", x2).at("y2", y)
    }

    /// The markup as a value that a template does not escape again.
    pub fn markup(&self) -> Safe<&str> {
        Safe(&self.0)
    }
}

/// Element of a drawing whose start tag is still open for attributes.
#[must_use = "the element stays open until `end`, `text` or `around`"]
pub struct Element<'a> {
    svg: &'a mut Svg,
    name: &'static str,
}

impl Element<'_> {
    /// Adds an attribute.
    pub fn with(self, name: &'static str, value: impl Display) -> Self {
        let markup = &mut self.svg.0;
        markup.push(' ');
        markup.push_str(name);
        markup.push_str("=\"");
        // A `String` takes any text.
        let _ = write!(Escaping(markup), "{value}");
        markup.push('"');
        self
    }

    /// Adds an attribute if there is a value.
    pub fn maybe(self, name: &'static str, value: Option<impl Display>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// Adds a coordinate or a length with one decimal.
    pub fn at(self, name: &'static str, value: f64) -> Self {
        self.with(name, format_args!("{value:.1}"))
    }

    /// Adds the attributes `x` and `y`.
    pub fn xy(self, x: f64, y: f64) -> Self {
        self.at("x", x).at("y", y)
    }

    /// Adds a line's colour and width.
    pub fn stroke(self, colour: &str, width: f64) -> Self {
        self.with("stroke", colour).with("stroke-width", width)
    }

    /// Ends an element without content.
    pub fn end(self) {
        self.svg.0.push_str("/>");
    }

    /// Ends the element with a text as its content.
    pub fn text(self, text: impl Display) {
        self.around(|svg| {
            let _ = write!(Escaping(&mut svg.0), "{text}");
        });
    }

    /// Ends the element with other elements as its content.
    pub fn around(self, content: impl FnOnce(&mut Svg)) {
        let Self { svg, name } = self;
        svg.0.push('>');
        content(svg);
        svg.0.push_str("</");
        svg.0.push_str(name);
        svg.0.push_str(">\n");
    }
}

/// Points of a line as the value of the attribute `points`.
pub fn points(all: impl IntoIterator<Item = (f64, f64)>) -> String {
    let point = |(x, y): (f64, f64)| format!("{x:.1},{y:.1}");
    let all: Vec<String> = all.into_iter().map(point).collect();
    all.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_texts_are_escaped_and_elements_are_closed() {
        let svg = Svg::drawing(
            |svg| svg.with("aria-label", "\"><script>"),
            |svg| {
                svg.element("rect")
                    .at("x", 0.26)
                    .maybe("rx", None::<u8>)
                    .end();
                svg.element("text").xy(1.0, 2.0).text("a < b & 'c'");
            },
        );
        assert_eq!(
            svg.markup().0.replace('\n', ""),
            concat!(
                "<svg aria-label=\"&quot;&gt;&lt;script&gt;\"><rect x=\"0.3\"/>",
                "<text x=\"1.0\" y=\"2.0\">a &lt; b &amp; &#39;c&#39;</text></svg>"
            )
        );
    }

    #[test]
    fn points_have_one_decimal() {
        assert_eq!(points([(1.0, 2.26), (3.04, 4.0)]), "1.0,2.3 3.0,4.0");
    }
}
