#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_texts.sh REPOSITORY LIST_TEXTS [--messages | --control | --missing]: every text that windows, reports and commands translate, every
# error's meaning, every text of the commands' help and of the data that they show has a Spanish one, none of them doubtful. With --messages
# the same of the messages of errors. With --control a text is taken away, and the check must notice; with --missing all that has no Spanish
# is printed as po/es.po needs it. Ends with 77 where gettext is missing.
set -euo pipefail
repository=$1 list_texts=$2
command -v xgettext >/dev/null && command -v msgcmp >/dev/null || { echo "gettext is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$repository"

# compare TEMPLATE: fails, naming them, where texts of it have no Spanish; the catalogue has more than any one template
compare() {
  msgcmp "$work/es.po" "$1" 2>"$work/complaint" && return 0
  grep -v 'this message is not used' "$work/complaint" || true
  return 1
}

"$list_texts" "$repository" >"$work/tables.pot"
# of calls: Translate("..."), the title of a card, and both texts of its lines
mapfile -t sources < <(find src -path '*/test' -prune -o \( -name '*.cpp' -o -name '*.h' \) -print | sort)
xgettext -L C++ --from-code=UTF-8 -k -kTranslate -kTranslateIn:1c,2 -kTranslateWith:1 -kTranslateCount:1,2 -kMark -kCard:1 -kAddLine:1 \
  -o "$work/calls.pot" "${sources[@]}" 2>/dev/null
xgettext -L C++ --from-code=UTF-8 -k -kAddLine:2 -o "$work/tips.pot" "${sources[@]}" 2>/dev/null
python3 -B tests/texts/list_console.py src/program/cli src/program/doctor src/imaging/anatomy src/imaging/contours src/imaging/images src/picture/view src/learn/dataset src/program/study src/program/bench/src >"$work/console.pot"
msgcat --use-first "$work/tables.pot" "$work/calls.pot" "$work/tips.pot" "$work/console.pot" -o "$work/all.pot"
python3 -B tests/texts/list_messages.py src/*/* >"$work/messages.pot"
cp po/es.po "$work/es.po"
if [ "${3:-}" = --missing ]; then
  msgcat --use-first "$work/all.pot" "$work/messages.pot" -o "$work/both.pot"
  msgmerge -q --no-fuzzy-matching --no-wrap "$work/es.po" "$work/both.pot" -o - | msgattrib --untranslated --no-obsolete --no-wrap
  exit 0
fi
if [ "${3:-}" = --control ]; then
  # of a table, and of the help of trocar window
  for text in "Stiffness" "Keep no attempt"; do
    cp po/es.po "$work/es.po"
    grep -q "^msgid \"$text\"$" "$work/es.po"
    sed -i "/^msgid \"$text\"$/{n;s/.*/msgstr \"\"/}" "$work/es.po"
    if compare "$work/all.pot" >/dev/null; then
      echo "\"$text\" without Spanish was not noticed"
      exit 1
    fi
    grep -q untranslated "$work/complaint"
  done
  echo "noticed"
  exit 0
fi
if [ "${3:-}" = --messages ]; then
  echo "$(grep -c '^msgid' "$work/messages.pot") messages"
  compare "$work/messages.pot"
  exit 0
fi
echo "$(grep -c '^msgid' "$work/all.pot") texts"
msgfmt --check --statistics -o /dev/null "$work/es.po"
compare "$work/all.pot"
