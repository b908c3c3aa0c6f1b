"""Executes a notebook and writes it with its outputs; a cell that fails ends it.

    pip install ./python pandas matplotlib nbclient ipykernel
    python python/examples/run_notebook.py python/examples/tutorial.ipynb executed.ipynb
"""

import sys

import nbclient
import nbformat


def main():
    source, executed = sys.argv[1:]
    notebook = nbformat.read(source, as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    figures = sum("image/png" in output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", []))
    nbformat.write(notebook, executed)
    print(f"{source}: {len(notebook.cells)} cells, {figures} figures")
    if figures < 2:
        sys.exit("figures are missing")


if __name__ == "__main__":
    main()
