#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads small data sets the way their users' own loaders do, into torch's loaders: read_as_others.py TROCAR_PROGRAM

The loaders themselves need packages that Debian has not (mmdet, torchvision, pycocotools). These stand-ins go through a set as the
published code does, key by key; what a loader would index is indexed here.
  SurgLatentGraph, datasets/custom_loading.py: CocoDatasetWithDS, VideoDatasetWithDS, its sampler of key frames, on mmdet's CocoDataset
  pycocotools: the index of images, annotations and categories, and run lengths
  cholect50, dataloader_pth.py: T50; ivtmetrics, disentangle.py and recognition.py: parts of a triplet, average precision
  TF-Cholec80 and the loaders after it: a phase for each frame at 25 a second, tools for every 25th
Exit status 77 where torch is missing.
"""
import csv
import hashlib
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
MISSING = [name for name in ("numpy", "torch") if importlib.util.find_spec(name) is None]
if MISSING and sys.executable != "/usr/bin/python3" and os.path.exists("/usr/bin/python3"):
    # another python may stand before the one that Debian's packages belong to
    os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])
if MISSING:
    print(f"skipped: {', '.join(MISSING)} cannot be imported; run tools/install-packages --test")
    sys.exit(77)

import numpy as np  # noqa: E402
import torch  # noqa: E402
from torch.utils.data import DataLoader, Dataset  # noqa: E402

LOADER = importlib.machinery.SourceFileLoader("verify_dataset", str(ROOT / "tools" / "verify-dataset"))
VERIFY = importlib.util.module_from_spec(importlib.util.spec_from_loader("verify_dataset", LOADER))
LOADER.exec_module(VERIFY)

CLASSES = ("cystic_plate", "calot_triangle", "cystic_artery", "cystic_duct", "gallbladder", "tool")


def jpeg_size(path):
    """(height, width) of its frame."""
    data, at = path.read_bytes(), 2
    while data[at] == 0xFF:
        length = int.from_bytes(data[at + 2:at + 4], "big")
        if data[at + 1] in (0xC0, 0xC1, 0xC2):
            return int.from_bytes(data[at + 5:at + 7], "big"), int.from_bytes(data[at + 7:at + 9], "big")
        at += 2 + length
    raise ValueError(f"{path}: no frame")


class Coco:
    """pycocotools' index, and the run lengths that it turns into masks."""

    def __init__(self, path):
        self.dataset = json.loads(path.read_text())
        self.imgs = {image["id"]: image for image in self.dataset["images"]}
        self.anns = {a["id"]: a for a in self.dataset["annotations"]}
        self.of_image = {}
        for a in self.dataset["annotations"]:
            self.of_image.setdefault(a["image_id"], []).append(a["id"])
        self.cats = {c["id"]: c for c in self.dataset["categories"]}

    def get_cat_ids(self, names):
        return [c["id"] for c in self.dataset["categories"] if c["name"] in names]

    def ann_to_mask(self, a):
        rle, image = a["segmentation"], self.imgs[a["image_id"]]
        assert isinstance(rle["counts"], list) and rle["size"] == [image["height"], image["width"]], "frPyObjects wants lists"
        flat = np.concatenate([np.full(n, i % 2, np.uint8) for i, n in enumerate(rle["counts"])])
        return flat.reshape(rle["size"][::-1]).T


class CocoDatasetWithDS(Dataset):
    """mmdet's CocoDataset.parse_data_info, and the keys that SurgLatentGraph adds to it."""

    def __init__(self, root, ann_file, prefix):
        self.coco, self.prefix = Coco(root / ann_file), root / prefix
        self.cat_ids = self.coco.get_cat_ids(CLASSES)
        self.cat2label = {cat: label for label, cat in enumerate(self.cat_ids)}
        self.ids = list(self.coco.imgs)

    def __len__(self):
        return len(self.ids)

    def __getitem__(self, index):
        image = self.coco.imgs[self.ids[index]]
        info = {"img_id": image["id"], "height": image["height"], "width": image["width"], "ds": np.array(image["ds"]),
                "is_det_keyframe": image["is_det_keyframe"], "video_id": image["video_id"]}
        path = self.prefix / image["file_name"]
        assert jpeg_size(path) == (info["height"], info["width"]), path
        boxes, labels, masks = [], [], []
        for ann_id in self.coco.of_image.get(image["id"], []):
            a = self.coco.anns[ann_id]
            x, y, w, h = a["bbox"]
            inter = max(0, min(x + w, image["width"]) - max(x, 0)) * max(0, min(y + h, image["height"]) - max(y, 0))
            if a.get("ignore", False) or inter == 0 or a["area"] <= 0 or w < 1 or h < 1 or a["category_id"] not in self.cat_ids:
                continue
            assert not a.get("iscrowd", False)
            boxes.append([x, y, x + w, y + h])
            labels.append(self.cat2label[a["category_id"]])
            masks.append(self.coco.ann_to_mask(a))
        info.update(boxes=np.array(boxes, np.float32).reshape(-1, 4), labels=np.array(labels), masks=masks)
        return info


class VideoDatasetWithDS:
    """Videos of annotation_coco_vid.json, and clips that end at key frames."""

    def __init__(self, root, ann_file):
        coco = Coco(root / ann_file)
        self.videos = []
        for video in coco.dataset["videos"]:
            images = [i for i in coco.dataset["images"] if i["video_id"] == video["id"]]
            placed = [None] * len(images)
            for image in images:
                placed[image["frame_id"]] = image  # as CocoVID puts them
            assert None not in placed
            self.videos.append(placed)

    def get_keyframes_per_video(self, index):
        return [i["frame_id"] for i in self.videos[index] if i["is_ds_keyframe"]]

    def clip(self, index, key, length=5):
        left = max(0, key + 1 - length)
        before = [i for i in range(left, key) if i != key] or [key]
        chosen = ([before[0]] * (length - 1 - len(before)) + before)[-(length - 1):] + [key]
        return torch.tensor([self.videos[index][i]["ds"] for i in chosen])


class T50(Dataset):
    """One video of CholecT50."""

    def __init__(self, root, video):
        self.labels = json.loads((root / "labels" / f"{video}.json").read_text())["annotations"]
        self.frames, self.folder = list(self.labels), root / "videos" / video

    def __len__(self):
        return len(self.frames)

    def __getitem__(self, index):
        frame = self.frames[index]
        picture = VERIFY.read_png(self.folder / f"{frame.zfill(6)}.png")
        out = [np.zeros(n) for n in (100, 6, 10, 15, 7)]
        for label in self.labels[frame]:
            for place, values in zip((0, 1, 7, 8, 14), out):
                if label[place] != -1:
                    values[label[place]] += 1
        return torch.tensor(picture.transpose(2, 0, 1).copy()), tuple(torch.tensor(v).bool().int() for v in out)


def average_precision(targets, scores):
    """scikit-learn's: sum of (R_n - R_{n-1}) P_n; NaN of a class that does not occur."""
    order = np.argsort(-scores, kind="stable")
    hits = np.cumsum(targets[order])
    if not hits[-1]:
        return np.nan
    precision, recall = hits / np.arange(1, len(hits) + 1), hits / hits[-1]
    return float(np.sum(np.diff(recall, prepend=0) * precision))


def decompose(bank, triplets, component):
    """A component of a vector of triplets, as ivtmetrics makes it."""
    key = {"i": 1, "v": 2, "t": 3, "iv": 4, "it": 5}[component]
    return np.array([[np.max(row[bank[:, key] == index]) for index in sorted(np.unique(bank[:, key]))] for row in triplets])


def make(program, folder, layout, seeds, seconds):
    subprocess.run([program, "dataset", "--layout", layout, "--seeds", seeds, "--size", "160x96", "--most-seconds", str(seconds),
                    "-o", folder], check=True, stdout=subprocess.DEVNULL)
    return pathlib.Path(folder)


def read_endoscapes(root):
    # seeds 1, 2 and 5 go to train, 3 to val, 4 to test
    for split, videos in (("train", 3), ("val", 1), ("test", 1)):
        frames = CocoDatasetWithDS(root, f"{split}/annotation_coco.json", split)
        judged = CocoDatasetWithDS(root, f"{split}/annotation_ds_coco.json", split)
        segmented = CocoDatasetWithDS(root, f"{split}_seg/annotation_coco.json", f"{split}_seg")
        assert len(frames) == 8 * videos and len(judged) == 2 * videos and len(segmented) == videos, (split, len(frames), len(judged))
        for dataset in (frames, judged, segmented):
            for item in DataLoader(dataset, batch_size=4, collate_fn=list):
                for one in item:
                    assert one["ds"].shape == (3,) and one["is_det_keyframe"] and len(one["labels"]) > 0, "annotations are missing"
                    name = dataset.coco.imgs[one["img_id"]]["file_name"][:-4]
                    semantic = VERIFY.read_png(root / "semseg" / f"{name}.png")
                    assert semantic.shape == (96, 160, 3) and (semantic == semantic[..., :1]).all()
                    for label, mask, box in zip(one["labels"], one["masks"], one["boxes"]):
                        assert (semantic[mask == 1] == label + 1).all(), "detection counts from 0 at the cystic plate"
                        y, x = np.nonzero(mask)
                        assert list(box) == [x.min(), y.min(), x.max() + 1, y.max() + 1]
        clips = VideoDatasetWithDS(root, f"{split}/annotation_coco_vid.json")
        for index in range(len(clips.videos)):
            assert clips.get_keyframes_per_video(index) == [0, 5]
            for key in clips.get_keyframes_per_video(index):
                assert clips.clip(index, key).shape == (5, 3)
        # lists are read as floats, then as whole numbers
        listed = [int(float(line)) for line in (root / f"{split}_vids.txt").read_text().split()]
        assert len(listed) == videos and len(list((root / f"{split}_seg").glob("*.jpg"))) == videos
    rows = list(csv.DictReader(open(root / "all_metadata.csv", newline="")))
    assert len(rows) == 40 and all(float(row[c]) in (0, 0.5, 1) for row in rows for c in ("C1", "C2", "C3"))
    assert (root / "seg_label_map.txt").read_text().split()[1:] == list(CLASSES)


def read_cholect50(root):
    bank = np.genfromtxt(root / "label_mapping.txt", dtype=int, comments="#", delimiter=",", skip_header=0)
    dataset = T50(root, "VID01")
    pictures, labels = next(iter(DataLoader(dataset, batch_size=len(dataset))))
    assert pictures.shape == (8, 3, 96, 160)
    triplets, tools, verbs, targets, phases = (label.numpy() for label in labels)
    assert (phases.sum(1) == 1).all() and tools.sum() > 0
    for part, component in ((tools, "i"), (verbs, "v"), (targets, "t")):
        # a triplet that has a number has its parts, too
        assert (part >= decompose(bank, triplets, component)).all(), component
    # who predicts the truth has precision 1 in every class that occurs
    precisions = [average_precision(triplets[:, c], triplets[:, c].astype(float)) for c in range(100)]
    assert np.nanmin(precisions) == 1 and np.isfinite(precisions).any()


def read_cholec80(root):
    phases = list(csv.reader(open(root / "phase_annotations" / "video01-phase.txt"), delimiter="\t"))[1:]
    tools = list(csv.reader(open(root / "tool_annotations" / "video01-tool.txt"), delimiter="\t"))
    assert tools[0][1:] == ["Grasper", "Bipolar", "Hook", "Scissors", "Clipper", "Irrigator", "SpecimenBag"]
    for row in tools[1:]:
        frame, name = phases[int(row[0])]
        assert frame == row[0] and name in VERIFY.CHOLEC80_PHASES
    assert len(tools) == 9 and any(row[1] == "1" for row in tools[1:])


def reseal(root):
    """Sums and card of a set that was changed on purpose."""
    lines = (root / "SHA256SUMS").read_text().splitlines()
    names = [line.split("  ", 1)[1] for line in lines]
    (root / "SHA256SUMS").write_text("".join(f"{hashlib.sha256((root / n).read_bytes()).hexdigest()}  {n}\n" for n in names))
    card = json.loads((root / "card.json").read_text())
    card["sha256sums"] = hashlib.sha256((root / "SHA256SUMS").read_bytes()).hexdigest()
    (root / "card.json").write_text(json.dumps(card))


def complaints(root):
    return subprocess.run([sys.executable, ROOT / "tools" / "verify-dataset", root], capture_output=True, text=True).stdout


def change_truth(root, video, change):
    path = root / "truth" / f"video_{video:05d}.csv"
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    change(rows)
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def verifier_asks_for_meaning(root):
    """Planted states: triangle clear, plate in part, no two structures. Only one order of the three is right."""
    def plant(rows):
        rows[0].update(triangle_cleared="0.95", plate_detached="0.2", structures_entering="3", criterion_triangle="2",
                       criterion_plate="1", criterion_structures="0")

    assert "good" in complaints(root), complaints(root)
    change_truth(root, 3, plant)
    files = [root / "val" / f"annotation_{kind}.json" for kind in ("coco", "ds_coco", "coco_vid")] + [root / "val_seg" / "annotation_coco.json"]
    for ds, is_right in (([0, 1, 0.5], True), ([0, 0.5, 1], False), ([1, 0, 0.5], False)):
        for file in files:
            coco = json.loads(file.read_text())
            coco["images"][0]["ds"] = ds
            file.write_text(json.dumps(coco))
        rows = list(csv.reader(open(root / "all_metadata.csv", newline="")))
        for row in rows:
            if row[:2] == ["3", "0"]:
                row[2:6] = [json.dumps(ds), *map(str, ds)]
        with open(root / "all_metadata.csv", "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)
        reseal(root)
        assert ("simulation's own" not in complaints(root)) == is_right, (ds, complaints(root))
    # what was spread is no idle hand
    change_truth(root, 3, lambda rows: rows[2].update(facts="right:strand_spread:triangle_strand::4"))
    reseal(root)
    assert "strand_spread by the right hand is labelled hook:null_verb:null_target" in complaints(root), complaints(root)


def main():
    program = sys.argv[1]
    torch.set_num_threads(1)
    with tempfile.TemporaryDirectory() as folder:
        endoscapes = make(program, f"{folder}/endoscapes", "endoscapes", "1:5", 7)
        read_endoscapes(endoscapes)
        verifier_asks_for_meaning(endoscapes)
        read_cholect50(make(program, f"{folder}/cholect50", "cholect50", "1:1", 7))
        read_cholec80(make(program, f"{folder}/cholec80", "cholec80", "1:1", 7))
    print("three layouts are read as their users do")
    return 0


if __name__ == "__main__":
    sys.exit(main())
