"""A little SVG: what the figures need, and nothing else."""

from html import escape

INK, GREY, LIGHT, PALE = "#1f2933", "#7b8794", "#cbd2d9", "#f5f7fa"
BLUE, ORANGE, GREEN, RED = "#2166ac", "#d95f02", "#1b7837", "#b2182b"
TINTS = ["#dbe9f6", "#fde7d3", "#dff0df", "#efe3f3", "#fbf3cf", "#e3f1f1"]
FONT = "font-family='Helvetica, Arial, sans-serif'"


class Figure:
    """A white page in pixels, y pointing down."""

    def __init__(self, width, height, title):
        self.width, self.height = width, height
        self.marks = [f"<title>{escape(title)}</title>", f"<rect width='{width}' height='{height}' fill='white'/>"]

    def text(self, x, y, words, size=13, colour=INK, anchor="start", bold=False, italic=False):
        weight = " font-weight='bold'" if bold else ""
        style = " font-style='italic'" if italic else ""
        for number, line in enumerate(words.split("\n")):
            self.marks.append(
                f"<text x='{x:.1f}' y='{y + 1.25 * size * number:.1f}' font-size='{size}' fill='{colour}' "
                f"text-anchor='{anchor}'{weight}{style}>{escape(line)}</text>"
            )

    def box(self, x, y, width, height, fill=PALE, stroke=GREY, thick=1.0, round_by=6):
        self.marks.append(
            f"<rect x='{x:.1f}' y='{y:.1f}' width='{width:.1f}' height='{height:.1f}' rx='{round_by}' fill='{fill}' "
            f"stroke='{stroke}' stroke-width='{thick}'/>"
        )

    def dot(self, x, y, radius=4.0, fill=INK, stroke="white"):
        self.marks.append(f"<circle cx='{x:.1f}' cy='{y:.1f}' r='{radius}' fill='{fill}' stroke='{stroke}'/>")

    def polygon(self, points, fill, stroke="none", opacity=1.0):
        listed = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.marks.append(f"<polygon points='{listed}' fill='{fill}' stroke='{stroke}' fill-opacity='{opacity}'/>")

    def line(self, points, colour=INK, thick=1.5, dashes="", arrow=False, arrow_back=False):
        listed = " ".join(f"{'M' if i == 0 else 'L'}{x:.1f} {y:.1f}" for i, (x, y) in enumerate(points))
        dashed = f" stroke-dasharray='{dashes}'" if dashes else ""
        self.marks.append(f"<path d='{listed}' fill='none' stroke='{colour}' stroke-width='{thick}'{dashed}/>")
        if arrow:
            self.head(points[-2], points[-1], colour, thick)
        if arrow_back:
            self.head(points[1], points[0], colour, thick)

    def head(self, behind, tip, colour, thick):
        """An arrow's head that ends at `tip`."""
        (bx, by), (tx, ty) = behind, tip
        length = ((tx - bx) ** 2 + (ty - by) ** 2) ** 0.5 or 1.0
        ux, uy = (tx - bx) / length, (ty - by) / length
        long, wide = 6.0 + 1.5 * thick, 2.5 + 0.8 * thick
        rx, ry = tx - long * ux, ty - long * uy
        self.polygon([(tx, ty), (rx - wide * uy, ry + wide * ux), (rx + wide * uy, ry - wide * ux)], colour)

    def curve(self, at, start, end, steps=60, **how):
        """The curve `at(t)` for t from `start` to `end`."""
        times = [start + (end - start) * i / steps for i in range(steps + 1)]
        self.line([at(t) for t in times], **how)

    def save(self, path):
        head = (
            f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {self.width} {self.height}' "
            f"width='{self.width}' height='{self.height}' {FONT}>\n"
        )
        path.write_text(head + "\n".join(self.marks) + "\n</svg>\n", encoding="utf-8")
