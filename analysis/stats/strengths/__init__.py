"""Strengths of conditions from choices among them: Bradley-Terry and Plackett-Luce."""
