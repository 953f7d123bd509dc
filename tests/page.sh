#!/usr/bin/env bash
# Opens a study's page in a browser, as wide as on a desk, in half a window and as on a phone, light and dark: are all
# pictures there, does everything fit so that no box scrolls, and is there nothing that it loads or complains of?
# Installs Chromium where it is missing.
# With a folder as its argument, the page and what the browser showed are left there.
set -euo pipefail
cd "$(dirname "$0")/.."

browser() {
    command -v chromium || command -v chromium-browser || command -v google-chrome
}

if ! browser >/dev/null; then
    if ! command -v apt-get >/dev/null; then
        echo "The page's test needs Chromium. Install it and run this again." >&2
        exit 1
    fi
    echo "installing Chromium"
    root=()
    [ "$(id -u)" -eq 0 ] || root=(sudo)
    "${root[@]}" apt-get update -qq
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq chromium >/dev/null
fi
chromium="$(browser)"

scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
folder="${1:-$scratch}"
mkdir -p "$folder"
folder="$(cd "$folder" && pwd)"

TAUTLINE_TEST_PAGE="$folder/report.html" \
    cargo test --release --quiet --test all pictures::the_page_has_everything_and_needs_nothing >"$scratch/test.log" 2>&1 ||
    { cat "$scratch/test.log" >&2; exit 1; }

# The page itself has no scripts. A copy of it gets one, which measures and leaves what it found in the document.
cat >"$scratch/measure.html" <<'HTML'
<script>
const faults = [];
addEventListener('error', event => faults.push('error: ' + (event.message || event.target.outerHTML)), true);
addEventListener('load', () => {
    const figures = [...document.querySelectorAll('figure')];
    for (const figure of figures) {
        const name = figure.querySelector('figcaption').textContent;
        const svg = figure.querySelector('svg');
        const box = svg.getBoundingClientRect();
        if (box.width < 200 || box.height < 100) faults.push(`${name}: ${box.width} x ${box.height} pixels`);
        const inside = r => r.left > box.left - 1 && r.right < box.right + 1 && r.top > box.top - 1 && r.bottom < box.bottom + 1;
        for (const text of svg.querySelectorAll('text')) {
            const r = text.getBoundingClientRect();
            if (r.width === 0) faults.push(`${name}: nothing is seen of "${text.textContent}"`);
            if (!inside(r)) faults.push(`${name}: "${text.textContent}" leaves the picture`);
            if (parseFloat(getComputedStyle(text).fontSize) * box.width / svg.viewBox.baseVal.width < 7)
                faults.push(`${name}: "${text.textContent}" is too small`);
        }
        if (svg.querySelectorAll('path, rect, circle').length < 3) faults.push(`${name}: nothing is drawn`);
    }
    for (const box of document.querySelectorAll('body *')) {
        const scrolls = ['auto', 'scroll'].includes(getComputedStyle(box).overflowX) && box.scrollWidth > box.clientWidth;
        if (scrolls) faults.push(`a box of ${box.scrollWidth} pixels scrolls in ${box.clientWidth}: ${box.textContent.slice(0, 60)}`);
    }
    for (const cell of document.querySelectorAll('tbody th, tbody td')) {
        const r = cell.getBoundingClientRect();
        if (r.width === 0 || r.left < 0 || r.right > innerWidth) faults.push(`a cell leaves the page: ${cell.textContent}`);
    }
    const isDark = matchMedia('(prefers-color-scheme: dark)').matches;
    for (const card of document.querySelectorAll('.card')) {
        const turned = getComputedStyle(card.querySelector('svg')).filter !== 'none';
        const white = getComputedStyle(card).backgroundColor === 'rgb(255, 255, 255)';
        if (turned !== isDark || white === isDark) faults.push(`a picture is not as ${isDark ? 'dark' : 'light'} as the page`);
    }
    const wide = document.documentElement.scrollWidth;
    if (wide > innerWidth) faults.push(`the page is ${wide} pixels wide, the window ${innerWidth}`);
    for (const entry of performance.getEntriesByType('resource')) faults.push('it loads ' + entry.name);
    top.postMessage(`figures: ${figures.length}, window: ${innerWidth}, faults: ${faults.length}\n${faults.join('\n')}`, '*');
});
</script>
HTML
awk -v script="$scratch/measure.html" '{ print } /^<head>$/ { while ((getline line < script) > 0) print line }' \
    "$folder/report.html" >"$scratch/measured.html"
figures="$(grep --count '^<figure>$' "$folder/report.html")"

# A window is never as narrow as a phone, so the page is shown in a frame: $1 its name, $2 and $3 its width and height,
# $4 whether the system is light or dark.
look() {
    local name="$1" width="$2" height="$3" page scheme=1
    [ "$4" = light ] || scheme=0
    for page in "$scratch/measured.html" "$folder/report.html"; do
        cat >"$scratch/$name-$(basename "$page")" <<HTML
<!DOCTYPE html>
<body style="margin: 0">
<script>
addEventListener('message', event => {
    const result = document.createElement('pre');
    result.id = 'measured';
    result.textContent = event.data;
    document.body.append(result);
});
</script>
<iframe src="file://$page" style="border: 0; width: ${width}px; height: ${height}px"></iframe>
HTML
    done
    local run=(timeout 120 "$chromium" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run
        --disable-background-networking --disable-component-update --disable-sync --hide-scrollbars
        --enable-logging=stderr "--user-data-dir=$scratch/profile-$name" "--window-size=$width,$height"
        "--blink-settings=preferredColorScheme=$scheme" --virtual-time-budget=5000)
    "${run[@]}" --dump-dom "file://$scratch/$name-measured.html" >"$scratch/$name.html" 2>"$scratch/$name.log" ||
        { cat "$scratch/$name.log" >&2; echo "$name: the browser failed" >&2; exit 1; }
    local measured
    measured="$(sed -n '/<pre id="measured"/,/<\/pre>/p' "$scratch/$name.html" | sed 's/<[^>]*>//g')"
    echo "$name: $measured"
    if [[ "$measured" != "figures: $figures, window: $width, faults: 0"* ]] || grep CONSOLE "$scratch/$name.log" >&2; then
        echo "$name: the page is not as it should be" >&2
        exit 1
    fi
    "${run[@]}" "--screenshot=$folder/$name.png" "file://$scratch/$name-report.html" >"$scratch/$name.log" 2>&1 ||
        { cat "$scratch/$name.log" >&2; echo "$name: the browser failed" >&2; exit 1; }
    # An empty page is a small file.
    [ "$(wc -c <"$folder/$name.png")" -gt 20000 ] || { echo "$name: the screenshot is empty" >&2; exit 1; }
}

[ "$figures" -eq 7 ] || { echo "$figures pictures are in the page, not 7" >&2; exit 1; }
look desk 1280 6200 light
look half 960 6200 dark
look phone 390 9000 light
