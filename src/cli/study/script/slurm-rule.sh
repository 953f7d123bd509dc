    # The study may be certain enough before all parts are done, so each looks now and then at what all have saved.
    while [ "$code" -eq 4 ] && ! enough && [ "$(($(date +%s) + @BEFORE@))" -lt "$SLURM_JOB_END_TIME" ]; do
        run
    done
    if enough; then
        return 0
    fi
