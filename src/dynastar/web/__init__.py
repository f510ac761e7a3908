"""Pages for the browser: the report of an episode as one HTML file."""

from dynastar.web.report import framed, report_html, write_report

__all__ = ["framed", "report_html", "write_report"]
