#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every method of `axguard-lab accuracy` on the cases of the folder tritri, judged by the checker
that came with them: one line a method and file.
Example: tests/tools/methods_table.py build/host-release ../shared/data/tritri"""
import json
import pathlib
import subprocess
import sys
import tempfile

# Beyond the domain of the certified test, or where float is coarser than the gaps themselves.
EXTREME = "overflow_products,denormal_coords,huge_vs_tiny,offset_1e5_um_gap"
HEAD = (f"{'method':30}{'missed':>8}{'deepest':>10}{'false':>7}{'undecided':>11}"
        f"{'farthest':>10}{'too far':>10}")


def totals(lab, folder, cases, method, scratch):
    result, document = scratch / "result.csv", scratch / "result.json"
    subprocess.run([lab, "accuracy", "--cases", folder / cases, "--method", method, "--output",
                    result], check=True, stdout=subprocess.DEVNULL)
    exclude = [] if "pose" in cases else [f"--exclude={EXTREME}"]
    run = subprocess.run([sys.executable, "-B", folder / "check.py", folder / "answers.csv", result,
                          "--quiet", f"--json={document}", *exclude], check=False)
    if run.returncode not in (0, 1):  # 1: it missed a contact, which is what is counted here
        sys.exit(f"check.py ended with {run.returncode}")
    return json.loads(document.read_text())["total"]


def main():
    lab = pathlib.Path(sys.argv[1]).resolve() / "axguard-lab"
    folder = pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as name:
        scratch = pathlib.Path(name)
        listed = scratch / "methods.json"
        subprocess.run([lab, "accuracy", "--list", f"--json={listed}"], check=True,
                       stdout=subprocess.DEVNULL)
        methods = json.loads(listed.read_text())["methods"]
        for cases in ("pairs_f32.bin", "pairs_f64.bin", "pairs_pose.bin"):
            first = totals(lab, folder, cases, "certified-f32", scratch)
            print(f"\n{cases}: {first['n']} cases, {first['exp1']} intersecting\n{HEAD}")
            for method in methods:
                t = totals(lab, folder, cases, method["name"], scratch)
                far = f"{t['dover']:.2g}" if method["distance"] else ""
                print(f"{method['name']:30}{t['FN']:8}{t['fndep']:10.3g}{t['FP']:7}"
                      f"{t['unc']:11}{t['maxgap']:10.3g}{far:>10}")
    print("\nmissed: called separated, and intersect; deepest: by their least overlap, um; false: "
          "called intersecting, and apart;\nfarthest: distance of a pair not told apart, um; too "
          "far: distance told beyond the true one, mm")


if __name__ == "__main__":
    main()
