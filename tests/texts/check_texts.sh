#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_texts.sh REPOSITORY LIST_TEXTS [--control]: every text that the windows translate, and every error, has a Spanish one, none
# of them doubtful. With --control a text is taken away, and the check must notice. Ends with 77 where gettext is missing.
set -euo pipefail
repository=$1 list_texts=$2
command -v xgettext >/dev/null && command -v msgcmp >/dev/null || { echo "gettext is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$repository"

"$list_texts" >"$work/tables.pot"
# of calls: Translate("..."), the title of a card, and both texts of its lines
mapfile -t sources < <(ls src/{presenter,app,gui,centre,editor}/{src,widgets}/*.cpp src/cli/src/*.cpp 2>/dev/null)
xgettext -L C++ --from-code=UTF-8 -k -kTranslate -kCard:1 -kAddLine:1 -o "$work/calls.pot" "${sources[@]}" 2>/dev/null
xgettext -L C++ --from-code=UTF-8 -k -kAddLine:2 -o "$work/tips.pot" "${sources[@]}" 2>/dev/null
msgcat --use-first "$work/tables.pot" "$work/calls.pot" "$work/tips.pot" -o "$work/all.pot"
cp po/es.po "$work/es.po"
if [ "${3:-}" = --control ]; then
  grep -q '^msgid "Stiffness"$' "$work/es.po"
  sed -i '/^msgid "Stiffness"$/{n;s/.*/msgstr ""/}' "$work/es.po"
  if msgcmp "$work/es.po" "$work/all.pot" 2>"$work/complaint"; then
    echo "a text without Spanish was not noticed"
    exit 1
  fi
  grep -q untranslated "$work/complaint"
  echo "noticed"
  exit 0
fi
echo "$(grep -c '^msgid' "$work/all.pot") texts"
msgfmt --check --statistics -o /dev/null "$work/es.po"
msgcmp "$work/es.po" "$work/all.pot"
