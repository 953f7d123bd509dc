#!/usr/bin/env bash
# Plays a trace in a browser: does the rope move by itself, does the slider move it, do moving SVGs move, and is there
# nothing that the page loads or complains of? Chromium is installed by tests/page.sh.
# With a folder as its argument, the page and what the browser showed are left there.
set -euo pipefail
cd "$(dirname "$0")/.."

if ! chromium="$(command -v chromium || command -v chromium-browser || command -v google-chrome)"; then
    echo "The animation's test needs Chromium; tests/page.sh installs it." >&2
    exit 1
fi

scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
folder="${1:-$scratch}"
mkdir -p "$folder"
folder="$(cd "$folder" && pwd)"

TAUTLINE_TEST_ANIMATION="$folder" \
    cargo test --release --quiet --test all drawings::the_page_that_plays_needs_nothing >"$scratch/test.log" 2>&1 ||
    { cat "$scratch/test.log" >&2; exit 1; }

# A copy of the page gets a script that looks at it from time to time and leaves what it found in the document.
cat >"$scratch/watch.html" <<'HTML'
<script>
const faults = [];
addEventListener('error', event => faults.push('error: ' + (event.message || event.target.outerHTML)), true);
// A browser without a screen draws hardly a frame while its clock is turned forward.
window.requestAnimationFrame = frame => setTimeout(() => frame(performance.now()), 16);
const after = milliseconds => new Promise(done => setTimeout(done, milliseconds));
addEventListener('load', async () => {
    const rope = () => document.getElementById('rope').getAttribute('points');
    const state = () => document.getElementById('state').textContent;
    const slider = document.getElementById('time');
    const button = document.getElementById('play');
    const expect = (there, what) => { if (!there) faults.push(`${what}: ${state()}, ${button.textContent}`); };
    const first = rope();
    await after(1500);
    expect(rope() !== first && Number(slider.value) > Number(slider.min), 'it does not play by itself');
    expect(button.textContent === 'Pause', 'the button does not say that it plays');
    button.click();
    const paused = rope();
    await after(500);
    expect(rope() === paused && button.textContent === 'Play', 'it does not pause');
    button.click();
    await after(1500);
    expect(rope() !== paused, 'it does not go on');
    slider.value = slider.max;
    slider.dispatchEvent(new Event('input'));
    expect(state().startsWith('step 500 of 500: '), 'the slider does not go to the end');
    const marks = ['left', 'right'].map(id => (document.getElementById(id).getAttribute('d').match(/M/g) || []).length);
    const turns = Number(state().match(/: (\d+) turn/)[1]);
    expect(turns > 2 && marks[0] + marks[1] === turns, 'the marks are not the turns');
    expect(document.getElementById('still').getAttribute('visibility') === 'hidden', 'two ropes are shown');
    slider.value = 250;
    slider.dispatchEvent(new Event('input'));
    expect(state().startsWith('step 250 of 500: '), 'the slider does not go back');
    if (document.documentElement.scrollWidth > innerWidth) faults.push('the page is too wide');
    for (const entry of performance.getEntriesByType('resource')) faults.push('it loads ' + entry.name);
    const result = document.createElement('pre');
    result.id = 'measured';
    result.textContent = `faults: ${faults.length}\n${faults.join('\n')}`;
    document.body.append(result);
});
</script>
HTML
awk -v script="$scratch/watch.html" '{ print } /^<head>$/ { while ((getline line < script) > 0) print line }' \
    "$folder/player.html" >"$scratch/watched.html"

run=(timeout 120 "$chromium" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run
    --disable-background-networking --disable-component-update --disable-sync --hide-scrollbars
    --enable-logging=stderr "--user-data-dir=$scratch/profile" --window-size=1000,900)

"${run[@]}" --virtual-time-budget=8000 --dump-dom "file://$scratch/watched.html" >"$scratch/player.html" 2>"$scratch/player.log" ||
    { cat "$scratch/player.log" >&2; echo "the browser failed" >&2; exit 1; }
measured="$(sed -n '/<pre id="measured"/,/<\/pre>/p' "$scratch/player.html" | sed 's/<[^>]*>//g')"
echo "player: $measured"
if [[ "$measured" != "faults: 0"* ]] || grep CONSOLE "$scratch/player.log" >&2; then
    echo "the page does not play as it should" >&2
    exit 1
fi

# The moving SVG at two times. As pictures they differ, and both show something.
for time in 2000 12000; do
    "${run[@]}" "--virtual-time-budget=$time" "--screenshot=$folder/moving-$time.png" "file://$folder/moving.svg" \
        >"$scratch/moving.log" 2>&1 || { cat "$scratch/moving.log" >&2; echo "the browser failed" >&2; exit 1; }
    grep CONSOLE "$scratch/moving.log" >&2 && exit 1
    [ "$(wc -c <"$folder/moving-$time.png")" -gt 10000 ] || { echo "the screenshot is empty" >&2; exit 1; }
done
if cmp -s "$folder/moving-2000.png" "$folder/moving-12000.png"; then
    echo "the SVG does not move" >&2
    exit 1
fi
echo "moving SVG: it moves"
