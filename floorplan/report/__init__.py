"""The report: one offline page with the plan, its evidence and its accuracy."""
