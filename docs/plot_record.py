"""Plots a record of an HRIR database: python3 docs/plot_record.py hair.hrir 7 record.png  (columns: data_schema/SCHEMA.md)"""
import json, pathlib, sqlite3, sys
import matplotlib.pyplot as plt, numpy as np
db = sqlite3.connect(pathlib.Path(sys.argv[1]).resolve().as_uri() + "?mode=ro", uri=True)
bake = json.loads(db.execute("SELECT settings FROM metadata").fetchone()[0])
row = db.execute("SELECT tau, tau_scale, re, re_scale FROM sector WHERE id = ?", (sys.argv[2],)).fetchone()
kind, full = (np.uint8, 255) if bake["storage"] == "u8" else (np.float16, 1)
tau = np.frombuffer(row[0], kind).reshape(bake["views"], bake["samples"]) * (row[1] / full)
re = np.frombuffer(row[2], kind).reshape(bake["views"], bake["lights"], bake["samples"]) * (row[3] / full)
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
figure.colorbar(left.imshow(1 - np.exp(-tau), extent=(0, 1, 360, 0), aspect="auto"), label="opacity: s, view [degrees]")
figure.colorbar(right.imshow(re.mean(axis=2), extent=(0, 360, 360, 0)), label="reflectance: light, view [degrees]")
figure.savefig(sys.argv[3])
