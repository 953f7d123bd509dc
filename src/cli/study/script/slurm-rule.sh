    # It looks now and then whether there is anything left to do.
    while [ "$code" -eq 4 ] && [ "$(($(date +%s) + @BEFORE@))" -lt "$SLURM_JOB_END_TIME" ]; do
        run
    done
