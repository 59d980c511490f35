/* The second monitor's sounds, and since when its connection is lost. The server decides what is
   said and when (pages/audience/sound.py); here a sentence is spoken, a tone closes in like that of
   a parking sensor. What is switched on stays in this browser and is sent nowhere. */
(() => {
  const GAP_MS = 4100, FAR_MS = 1200, NEAR_MS = 110, NEVER = -1e9;
  const NOTES = { reached: [784], captured: [784, 1175], alarm: [523, 392, 523, 392] };
  const on = { tones: false, voice: false };
  let operator = "", audio = null, spoken = NEVER, waiting = 0, beeped = NEVER, lost = "";
  const played = { cue: null, speech: null };

  const allowed = () => navigator.userActivation?.hasBeenActive ?? true;

  function note(hertz, after_s, seconds) {
    audio ??= new AudioContext();
    if (audio.state === "suspended") audio.resume();
    const start = audio.currentTime + after_s, wave = audio.createOscillator();
    const volume = audio.createGain();
    wave.frequency.value = hertz;
    // A hard edge would click.
    volume.gain.setValueAtTime(0, start);
    volume.gain.linearRampToValueAtTime(0.3, start + 0.01);
    volume.gain.linearRampToValueAtTime(0, start + seconds);
    wave.connect(volume).connect(audio.destination);
    wave.start(start);
    wave.stop(start + seconds);
  }

  function speak(text, language) {
    clearTimeout(waiting);
    const rest = spoken + GAP_MS - performance.now();
    if (rest > 0) {
      waiting = setTimeout(() => speak(text, language), rest);
      return;
    }
    spoken = performance.now();
    const words = new SpeechSynthesisUtterance(text);
    words.lang = language;
    speechSynthesis.cancel();
    speechSynthesis.speak(words);
  }

  /* Whether an element's number is new; the first one seen is not, since it is from before. */
  function isNew(name, element) {
    const before = played[name];
    played[name] = Number(element.dataset.number);
    return before !== null && played[name] > before;
  }

  function beep(distance) {
    const now = performance.now();
    if (now - beeped >= NEAR_MS + (FAR_MS - NEAR_MS) * distance) {
      beeped = now;
      note(1047, 0, 0.07);
    }
  }

  function sound() {
    const moment = document.querySelector(".v-audience");
    const speech = document.querySelector(".v-speech"), cue = document.querySelector(".v-cue");
    if (!moment || !speech || !cue) return;
    const said = isNew("speech", speech), achieved = isNew("cue", cue);
    if (lost || !allowed()) return;
    if (said && on.voice) speak(speech.textContent, speech.lang);
    if (achieved && on.tones) {
      NOTES[cue.dataset.cue].forEach((hertz, i) => note(hertz, 0.14 * i, 0.22));
      beeped = performance.now();
    } else if (on.tones && moment.dataset.left && !document.hidden) {
      beep(Number(moment.dataset.left));
    }
  }

  function show() {
    const switches = document.querySelector(".v-sound");
    if (switches && switches.dataset.on !== operator) {
      operator = switches.dataset.on;
      for (const kind of Object.keys(on)) on[kind] = operator.includes(kind);
    }
    for (const button of document.querySelectorAll("[data-sound]")) {
      const pressed = String(on[button.dataset.sound]);
      if (button.getAttribute("aria-pressed") !== pressed) {
        button.setAttribute("aria-pressed", pressed);
      }
    }
    const asks = String((on.tones || on.voice) && !allowed());
    if (document.body.dataset.asks !== asks) document.body.dataset.asks = asks;
  }

  function tellLost() {
    const isLost = document.querySelector(".mantine-Loader-root") !== null;
    const clock = { hour: "2-digit", minute: "2-digit", hourCycle: "h23" };
    lost = isLost ? lost || new Date().toLocaleTimeString([], clock) : "";
    const since = document.querySelector(".v-lost b");
    if (isLost && since && since.textContent !== lost) since.textContent = lost;
  }

  document.addEventListener("click", (event) => {
    const kind = event.target.closest("[data-sound]")?.dataset.sound;
    if (kind) on[kind] = !on[kind];
    if (on.tones && kind !== "voice") note(784, 0, 0.1);
    if (kind === "voice") {
      clearTimeout(waiting);
      const now = document.querySelector(".v-say"), speech = document.querySelector(".v-speech");
      if (!on.voice) speechSynthesis.cancel();
      else if (now && speech) speak(now.dataset.spoken, speech.lang);
    }
    show();
  });
  setInterval(() => { show(); tellLost(); sound(); }, 50);
})();
