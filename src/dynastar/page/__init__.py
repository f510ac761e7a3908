"""The page that replays episodes in a browser: one HTML file, which needs no package and no network."""

from dynastar.page.report import framed, report_html, write_report

__all__ = ["framed", "report_html", "write_report"]
