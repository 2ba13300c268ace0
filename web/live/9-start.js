const later_ = (promise) => promise.catch((error) => byId("live").append(warn(error.message)));

if (run.tower) whatIfPart();
progressPart();
later_(runsPart());
if (run.tower) later_(startWhatIf(state.marked ?? rowOf.get(run.knee), false).then(completeSummary)); // the scene comes at once
